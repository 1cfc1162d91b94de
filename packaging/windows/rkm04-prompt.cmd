@rem SPDX-License-Identifier: MIT
@rem A prompt in which rkm04 is known; with arguments: rkm04 with them.
@echo off
cd /d "%~dp0"
set "PATH=%~dp0;%PATH%"
if not "%~1"=="" (
    rkm04 %*
    goto :eof
)
rkm04 --help
cmd /k
