" SPDX-License-Identifier: MIT
autocmd BufNewFile,BufRead *.rks setfiletype rks
