# SPDX-License-Identifier: MIT
# cmake -D SOURCE=… -D BUILD=… -P BuildRelease.cmake: the programs as they are delivered, without tests, for the tests release_*.
foreach(arguments "-S;${SOURCE};-B;${BUILD};-DCMAKE_BUILD_TYPE=Release;-DRKM04_TESTS=OFF" "--build;${BUILD};-j;2")
  execute_process(COMMAND ${CMAKE_COMMAND} ${arguments} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
