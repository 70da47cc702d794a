# 64-bit Arm, by Debian's cross compiler. Programs run where they are built through qemu-user, if it is there.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
find_program(PLUMB_QEMU NAMES qemu-aarch64-static qemu-aarch64)
if(PLUMB_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR "${PLUMB_QEMU};-L;/usr/aarch64-linux-gnu")
endif()
# Libraries of headers alone are those of the machine that compiles.
set(CMAKE_FIND_ROOT_PATH /usr/aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
