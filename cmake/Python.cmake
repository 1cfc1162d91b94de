# SPDX-License-Identifier: MIT
# The Python that the extension is built against: any from 3.9 on, the extension keeps to the stable ABI. For Windows it is that of
# tools/windows-python (WindowsPrograms.cmake).
if(RKM04_PYTHON AND NOT WIN32)
  find_package(Python 3.9 COMPONENTS Interpreter Development.Module)
  if(Python_FOUND)
    set(CMAKE_POSITION_INDEPENDENT_CODE ON)
    add_compile_options(-fvisibility=hidden -fno-semantic-interposition)
  elseif(SKBUILD)
    message(FATAL_ERROR "the headers of Python 3.9 or later are needed (Debian: python3-dev)")
  else()
    message(STATUS "the Python extension is left out: the headers of Python are not there (Debian: python3-dev)")
    set(RKM04_PYTHON OFF)
  endif()
endif()
