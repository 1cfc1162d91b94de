@rem SPDX-License-Identifier: MIT
@rem The window in the browser; with arguments: rkmctl window with them. Closing this prompt ends it.
@echo off
if not "%~1"=="" (
    "%~dp0rkmctl" window %*
    goto :eof
)
"%~dp0rkmctl" window --open
pause
