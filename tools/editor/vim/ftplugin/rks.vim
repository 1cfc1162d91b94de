" SPDX-License-Identifier: MIT
" Programs of the RKM04: gq lays out, :make checks, % finds { }.
if exists('b:did_ftplugin')
  finish
endif
let b:did_ftplugin = 1

setlocal commentstring={%s}
setlocal comments=
setlocal expandtab shiftwidth=4 softtabstop=4
setlocal matchpairs=[:],{:}
setlocal formatprg=rkm04\ fmt\ -
setlocal makeprg=rkm04\ check\ --format\ gcc\ %:S
setlocal errorformat=%f:%l:%c:\ %trror:\ %m,%f:%l:%c:\ %tarning:\ %m
let b:undo_ftplugin = 'setlocal commentstring< comments< expandtab< shiftwidth< softtabstop< matchpairs<'
      \ . ' formatprg< makeprg< errorformat<'
