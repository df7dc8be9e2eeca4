# CMake's toolchain file for 64-bit ARM from another processor, with Debian's compiler; programs run in qemu (make test-arm).
# That compiler looks into /usr/include too, after its own folders: header-only libraries are the host's.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L /usr/aarch64-linux-gnu)
