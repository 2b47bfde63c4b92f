"""Compilation of kernels by numba, their cache on disk, and checks of the sizes of their arrays."""
