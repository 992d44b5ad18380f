"""Windows, made with Qt and pyqtgraph. These packages are imported only when a window opens."""
