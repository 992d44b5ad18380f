"""Environment variables that let libraries compute as on other processors."""

from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

DISPATCHED = [name for name in __cpu_dispatch__ if __cpu_features__.get(name)]
NUMPY_PLAIN = {"NPY_DISABLE_CPU_FEATURES": " ".join(DISPATCHED)}
LIBM_WITHOUT_FMA = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}
