# SPDX-License-Identifier: MIT
# The Debian package (docs/INSTALL.md) and what else a system wants beside programs and library: units of systemd, documents.
#
# It is one package: the library is static and small, nothing on the system loads it, and who writes a test bench with it wants
# the emulator and the client at hand. A -dev package would be a second thing to install and be of no use.

# Paths below the prefix, as systemd looks for them in /usr and in /usr/local.
if(RKM04_HOST)
  install(FILES packaging/systemd/system/rkm04@.service DESTINATION lib/systemd/system)
  install(FILES packaging/systemd/user/rkm04@.service DESTINATION lib/systemd/user)
endif()
# Completion in the shells, from what the programs say of themselves.
if(RKM04_HOST AND NOT CMAKE_CROSSCOMPILING)
  install(CODE "execute_process(COMMAND ${CMAKE_COMMAND} -E env RKM04=${PROJECT_BINARY_DIR}/rkm04
    RKMCTL=${PROJECT_BINARY_DIR}/rkmctl ${PROJECT_SOURCE_DIR}/tools/completions ${PROJECT_BINARY_DIR}/completions
    COMMAND_ERROR_IS_FATAL ANY)")
  install(DIRECTORY ${PROJECT_BINARY_DIR}/completions/bash/ DESTINATION share/bash-completion/completions)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/completions/zsh/ DESTINATION share/zsh/vendor-completions)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/completions/fish/ DESTINATION share/fish/vendor_completions.d)
endif()
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN man EXCLUDE)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES packaging/debian/copyright THIRD-PARTY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

# Editor support (docs/EDITORS.md).
install(DIRECTORY tools/editor DESTINATION share/rkm04)

# The conformance kit finds its cases beside its own place: PREFIX/bin and PREFIX/share/rkm04/conformance.
file(GLOB KIT CONFIGURE_DEPENDS tests/conformance/*.py tests/conformance/*.json)
install(PROGRAMS tools/conformance DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME rkm04-conformance)
install(FILES ${KIT} DESTINATION share/rkm04/conformance)

set(RKM04_MAINTAINER "the authors of the virtual RKM04 <maintainers@users.noreply.h-seed-2f7931ad.example>"
  CACHE STRING "Whom the Debian package names as its maintainer")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rkm04)
set(CPACK_PACKAGE_CONTACT ${RKM04_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "virtual RKM04, a unit for four stepper motors on RS485")
set(CPACK_PACKAGE_DESCRIPTION
"rkm04 takes the place of SofCon's RKM04 on a serial line: the same messages,
the same answers, the same pulses at the same microsecond. Host software is
tested with it without motors, on a pseudo terminal, a serial device or over
TCP; programs are tried out in virtual time.
.
The package holds the emulator rkm04, the client rkmctl, the conformance kit
rkm04-conformance, units for systemd, documents, examples, and the emulator's
core as a C library.")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/DebianFiles.cmake)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION electronics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "python3:any") # of rkm04-conformance
if(RKM04_WINDOW)
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", libwebsockets-evlib-uv") # loaded by libwebsockets when rkm04-window starts
endif()
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-serial, librsvg2-bin")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gtkwave, wireshark")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/debian/prerm ${PROJECT_SOURCE_DIR}/packaging/debian/postrm)
set(CPACK_RKM04_CHANGELOG ${PROJECT_SOURCE_DIR}/CHANGELOG.md)
set(CPACK_RKM04_STRIP ${CMAKE_STRIP})
include(CPack)
