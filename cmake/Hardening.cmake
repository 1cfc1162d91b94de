# SPDX-License-Identifier: MIT
# Hardening of what runs beside other programs (docs/SECURITY.md): every optimised build has it, but not one with sanitizers,
# which look for the same and more. tests/system/security.sh looks whether it is in the programs.
option(RKM04_HARDEN "Harden optimised builds: PIE, RELRO, stack protector, fortified library calls" ON)

if(NOT WIN32)
  add_compile_options(-Werror=format-security)
endif()
if(RKM04_HARDEN AND NOT RKM04_SANITIZE AND NOT WIN32)
  set(optimised $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
  # -U: builders of packages define a level of their own. -fPIE, not -fPIC, which would keep the core from calling its own
  # functions directly; in the Python extension the options of its target do that.
  set(position_independent -fPIE)
  if(RKM04_PYTHON)
    set(position_independent -fPIC)
  endif()
  foreach(option ${position_independent} -fstack-protector-strong -fstack-clash-protection -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3)
    add_compile_options($<${optimised}:${option}>)
  endforeach()
  # Jumps and returns lead only to where they may.
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64)
    add_compile_options($<${optimised}:-fcf-protection=full>)
  elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
    add_compile_options($<${optimised}:-mbranch-protection=standard>)
  endif()
  foreach(option -Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)
    add_link_options($<${optimised}:${option}>)
  endforeach()
  add_link_options($<$<AND:${optimised},$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>>:-pie>)
endif()
