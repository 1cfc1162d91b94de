/* SPDX-License-Identifier: MIT */
/* start.S: what happens before main. QEMU's virt machine begins at the start of its RAM. No interrupt is ever taken: WFI wakes
 * for what is enabled in mie, and the main loop looks by itself. */
    .section .start, "ax"
    .globl start
start:
    la      sp, stack_top
    la      t0, trap
    csrw    mtvec, t0
    la      t0, bss_begin
    la      t1, bss_end
1:  bgeu    t0, t1, 2f
    sw      zero, 0(t0)
    addi    t0, t0, 4
    j       1b
2:  call    main
    .align 2
trap:           /* a fault of the processor: begin anew, the programs are in flash */
    j       start
