# CMake's toolchain file for 64-bit ARM on another processor, with Debian's compiler. Programs run in qemu (make
# test-arm). After its own folders the compiler searches /usr/include too: header-only libraries are the host's.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 -L /usr/aarch64-linux-gnu)
