"""Tables: CSV files that people write, and Parquet and CSV files for pandas and R, written piece by piece."""
