" SPDX-License-Identifier: MIT
" Programs of the RKM04. What no rule takes is an error; a number may stand in the line after its command.
if exists('b:current_syntax')
  finish
endif

syntax case match
syntax match rksError /\S/
syntax match rksMotion /[RHY]/
syntax match rksMotion /G\_s*\(\d\+\|[+-]\)/ contains=rksNumber,rksSign
syntax match rksMotion /[()]\_s*\d\+/ contains=rksNumber
syntax match rksParameter /[ABFSVW]\_s*\d\+/ contains=rksNumber
syntax match rksParameter /=\_s*-\?\_s*\d\+/ contains=rksNumber,rksSign
syntax match rksParameter /D/
syntax match rksInOut /[CTOZMNX]\_s*\d\+/ contains=rksNumber
syntax match rksControl /[UK\\]/
syntax match rksFlow /[E.\[\]]/
syntax match rksFlow /L\_s*\d\+/ contains=rksNumber
syntax match rksFlow /\(J\|['"´‘’„]\)\_s*\d\+/ contains=rksLabelNumber
syntax match rksFlow /I\_s*\d\+\_s*[HL]\_s*\d\+/ contains=rksNumber,rksTarget
syntax match rksLabel /@\_s*\d\+/
syntax match rksNumber /\d\+/ contained
syntax match rksSign /[+-]/ contained
syntax match rksLabelNumber /\d\+/ contained
syntax match rksTarget /\([HL]\_s*\)\@<=\d\+/ contained
syntax region rksComment start=/{/ end=/}/ contains=rksNolint
syntax match rksNolint /{\@<=nolint\(-file\)\?\>/ contained

highlight default link rksError Error
highlight default link rksMotion Function
highlight default link rksParameter Identifier
highlight default link rksInOut Type
highlight default link rksControl Special
highlight default link rksFlow Conditional
highlight default link rksLabel Label
highlight default link rksLabelNumber Label
highlight default link rksTarget Label
highlight default link rksNumber Number
highlight default link rksSign Number
highlight default link rksComment Comment
highlight default link rksNolint PreProc

let b:current_syntax = 'rks'
