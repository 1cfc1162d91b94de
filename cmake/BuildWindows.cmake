# SPDX-License-Identifier: MIT
# cmake -D SOURCE=… -D BUILD=… -P BuildWindows.cmake: rkm04.exe in BUILD, its libraries in BUILD/libraries, for the test
# system_windows.
execute_process(COMMAND ${SOURCE}/tools/windows-libraries ${BUILD}/libraries COMMAND_ERROR_IS_FATAL ANY)
foreach(arguments "-S;${SOURCE};-B;${BUILD};-DCMAKE_TOOLCHAIN_FILE=${SOURCE}/cmake/WindowsToolchain.cmake;\
-DRKM04_WINDOWS_LIBRARIES=${BUILD}/libraries;-DCMAKE_BUILD_TYPE=Release;-DRKM04_TESTS=OFF" "--build;${BUILD};-j;2")
  execute_process(COMMAND ${CMAKE_COMMAND} ${arguments} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
