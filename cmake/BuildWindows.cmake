# SPDX-License-Identifier: MIT
# cmake -D SOURCE=… -D BUILD=… -P BuildWindows.cmake: rkm04.exe in BUILD, its libraries in BUILD/libraries, a Python for Windows and
# the extension for it where Maven is there, for the tests system_windows*.
execute_process(COMMAND ${SOURCE}/tools/windows-libraries ${BUILD}/libraries COMMAND_ERROR_IS_FATAL ANY)
set(python OFF)
find_program(maven mvn)
if(maven)
  execute_process(COMMAND ${SOURCE}/tools/windows-python ${BUILD}/python-for-windows RESULT_VARIABLE result)
  if(result EQUAL 0)
    set(python ON)
  elseif(NOT result EQUAL 77) # 77: Maven Central is not reached
    message(FATAL_ERROR "there is no Python for Windows")
  endif()
endif()
foreach(arguments "-S;${SOURCE};-B;${BUILD};-DCMAKE_TOOLCHAIN_FILE=${SOURCE}/cmake/WindowsToolchain.cmake;\
-DRKM04_WINDOWS_LIBRARIES=${BUILD}/libraries;-DRKM04_PYTHON=${python};-DRKM04_WINDOWS_PYTHON=${BUILD}/python-for-windows;\
-DCMAKE_BUILD_TYPE=Release;-DRKM04_TESTS=OFF" "--build;${BUILD};-j;2")
  execute_process(COMMAND ${CMAKE_COMMAND} ${arguments} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
