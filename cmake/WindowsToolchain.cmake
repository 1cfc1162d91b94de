# SPDX-License-Identifier: MIT
# Programs for Windows from Debian's mingw-w64 (docs/WINDOWS.md), with the libraries that tools/windows-libraries builds.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(RKM04_WINDOWS_LIBRARIES ${CMAKE_CURRENT_LIST_DIR}/../build/windows-libraries CACHE PATH "Made by tools/windows-libraries")
set(RKM04_WINDOWS_PYTHON ${CMAKE_CURRENT_LIST_DIR}/../build/windows-python CACHE PATH "Made by tools/windows-python")
set(CMAKE_FIND_ROOT_PATH ${RKM04_WINDOWS_LIBRARIES})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
