@rem SPDX-License-Identifier: MIT
@rem A unit for host software, over TCP; with arguments: rkm04 serve with them. Closing the window ends it.
@echo off
if not "%~1"=="" (
    "%~dp0rkm04" serve %*
    goto :eof
)
"%~dp0rkm04" serve --tcp 4001 --rfc2217 4002
pause
