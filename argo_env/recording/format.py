"""What tells a recording and its format."""

VERSION = "2"
"""of what a recording of Argo's holds"""
MAGIC = b"\x89MCAP0\r\n"
"""what every .mcap file begins and ends with (MCAP specification)"""
