# SPDX-License-Identifier: MIT
# rkm04.exe, and rkmctl.exe with the window in it: with src/windows in place of what POSIX has (docs/WINDOWS.md).
find_library(JANSSON jansson REQUIRED)
find_library(YAML yaml REQUIRED)
find_library(UV uv_a REQUIRED)
find_library(LWS websockets_static REQUIRED)
set(system_libraries psapi user32 advapi32 iphlpapi userenv ws2_32)
enable_language(RC)

# What POSIX has of these rooms, src/windows has for Windows.
set(posix_only device/device_kinds_added.c options/process.c options/socket_address.c plot/raster.c program_tools/text_diff.c
  line/line.c line/line_poll.c line/line_pty.c line/line_raw.c line/line_serial.c line/line_speed.c line/link_path.c
  line/net_socket.c line/wake_timer.c line/wine_link.c bus/bus_pty.c
  control/control_system.c serve/notify.c serve/sandbox.c serve/sandbox_calls.c serve/serve_process.c serve/serve_sandbox.c serve/serve_window.c)
set(posix ${CMAKE_CURRENT_SOURCE_DIR}/windows/posix)

function(use_windows target)
  target_include_directories(${target} BEFORE PUBLIC ${posix})
  target_include_directories(${target} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_BINARY_DIR}
    ${RKM04_WINDOWS_LIBRARIES}/include)
  target_compile_definitions(${target} PRIVATE _GNU_SOURCE __USE_MINGW_ANSI_STDIO=1 _FILE_OFFSET_BITS=64 WIN32_LEAN_AND_MEAN YAML_DECLARE_STATIC)
  target_compile_options(${target} PRIVATE -include ${posix}/posix.h)
endfunction()

add_rooms(rkm04-sim ${SIM_ROOMS} plot run line bus control serve windows)
get_target_property(sources rkm04-sim SOURCES)
set(windows_client windows/client_screen.c windows/client_socket.c windows/client_typing.c windows/client_window.c windows/port.c)
set(windows_window windows/window_devices.c windows/window_system.c)
foreach(source ${posix_only} ${windows_client} ${windows_window})
  list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/${source})
endforeach()
set_target_properties(rkm04-sim PROPERTIES SOURCES "${sources};${page_js}")
use_windows(rkm04-sim)
set_source_files_properties(line/net_address.c options/host_address.c PROPERTIES COMPILE_OPTIONS "-include;${posix}/sockets.h")
target_link_libraries(rkm04-sim PUBLIC rkm04-core ${JANSSON} ${YAML} ${UV} ${system_libraries})

add_executable(rkm04 main/main.c windows/rkm04.rc)
use_windows(rkm04)
target_link_libraries(rkm04 PRIVATE rkm04-sim -static pthread)

file(GLOB client_files CONFIGURE_DEPENDS client/*.c)
foreach(name port screen socket terminal typing window)
  list(REMOVE_ITEM client_files ${CMAKE_CURRENT_SOURCE_DIR}/client/client_${name}.c)
endforeach()
add_executable(rkmctl main/rkmctl.c windows/rkm04.rc ${windows_client} ${client_files})
use_windows(rkmctl)
set_source_files_properties(client/client_link.c client/client_pmc.c client/client_pmc_way.c client/client_request.c PROPERTIES
  COMPILE_OPTIONS "-include;${posix}/port_names.h")
file(GLOB window_files CONFIGURE_DEPENDS window/*.c)
foreach(name devices system)
  list(REMOVE_ITEM window_files ${CMAKE_CURRENT_SOURCE_DIR}/window/window_${name}.c)
endforeach()
add_library(rkm04-window-server STATIC ${windows_window} ${window_files})
use_windows(rkm04-window-server)
set_source_files_properties(window/window_port_work.c PROPERTIES COMPILE_OPTIONS "-include;${posix}/port_names.h")
include(${PROJECT_SOURCE_DIR}/cmake/WindowPages.cmake)
target_link_libraries(rkm04-window-server PUBLIC rkm04-sim ${LWS} ${UV} ${system_libraries} shell32 ole32)
target_link_libraries(rkmctl PRIVATE rkm04-window-server rkm04-sim -static pthread)
set_target_properties(rkm04 rkmctl PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})

# The extension of the Python package, against the stable ABI: python3.dll.
if(RKM04_PYTHON)
  file(GLOB python_files CONFIGURE_DEPENDS python/*.c)
  add_library(rkm04-python MODULE ${python_files})
  use_windows(rkm04-python)
  target_include_directories(rkm04-python SYSTEM PRIVATE ${RKM04_WINDOWS_PYTHON}/include)
  target_link_libraries(rkm04-python PRIVATE rkm04-sim -static pthread ${RKM04_WINDOWS_PYTHON}/libs/python3.lib)
  set_target_properties(rkm04-python PROPERTIES PREFIX "" OUTPUT_NAME _sim SUFFIX .pyd
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/rkm04)
  install(TARGETS rkm04-python LIBRARY DESTINATION rkm04 COMPONENT python EXCLUDE_FROM_ALL)
  install(TARGETS rkm04 rkmctl RUNTIME DESTINATION rkm04/bin COMPONENT python EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/python/urlhandler/protocol_rkm04.py DESTINATION serial/urlhandler COMPONENT python
    EXCLUDE_FROM_ALL)
endif()

# A zip with the program, the documents and a prompt (cpack --preset windows).
install(TARGETS rkm04 rkmctl RUNTIME DESTINATION .)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/packaging/windows/rkm04-prompt.cmd ${PROJECT_SOURCE_DIR}/packaging/windows/rkm04-serve.cmd
  ${PROJECT_SOURCE_DIR}/packaging/windows/rkm04-window.cmd DESTINATION .)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/THIRD-PARTY.md
  ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION .)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples DESTINATION . PATTERN man EXCLUDE)
set(CPACK_GENERATOR ZIP)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_FILE_NAME rkm04-${PROJECT_VERSION}-windows)
include(CPack)
