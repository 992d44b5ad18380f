"""Windows: Qt and pyqtgraph, imported only when a window opens."""
