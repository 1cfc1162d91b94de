# SPDX-License-Identifier: MIT
# Run by CPack between installing into the package's folder and packing it: what Debian wants otherwise than `cmake --install`
# puts it in place. Manual pages and changelogs are compressed, the library has no debug symbols.
set(share ${CPACK_TEMPORARY_DIRECTORY}/usr/share)
set(documents ${share}/doc/${CPACK_PACKAGE_NAME})

# The time of the package, of $SOURCE_DATE_EPOCH if that is set.
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${documents}/changelog.Debian
"${CPACK_PACKAGE_NAME} (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Built from the source; its changes are in changelog.gz.

 -- ${CPACK_PACKAGE_CONTACT}  ${now}
")
configure_file(${CPACK_RKM04_CHANGELOG} ${documents}/changelog COPYONLY)

file(GLOB pages ${share}/man/man*/*.[1-9])
execute_process(COMMAND gzip -9nf ${pages} ${documents}/changelog ${documents}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
file(GLOB_RECURSE libraries ${CPACK_TEMPORARY_DIRECTORY}/usr/lib/*.a)
execute_process(COMMAND ${CPACK_RKM04_STRIP} --strip-debug --enable-deterministic-archives ${libraries} COMMAND_ERROR_IS_FATAL ANY)

# The Python of the system, which has the packages that this one depends on.
set(kit ${CPACK_TEMPORARY_DIRECTORY}/usr/bin/rkm04-conformance)
file(READ ${kit} text)
string(REPLACE "#!/usr/bin/env python3\n" "#!/usr/bin/python3\n" text "${text}")
file(WRITE ${kit} "${text}")
