/* SPDX-License-Identifier: MIT */
/* cell_table.h: all cells of the interface between CNC system and PLC program, and the fields of a block in the queue (sections 3
 * and NQ1). Translator, control socket, `rkm04 signals` and the constants of the core are made from these lists. */
#ifndef CNC872_CELL_TABLE_H
#define CNC872_CELL_TABLE_H

/* OWN(name, type, count, access, fields, preset, section): a cell with memory of its own.
 * SAME(name, other, offset, type, count, access, section): memory of another cell from a byte offset on. */
#define CNC_NUMBERS(OWN, SAME) \
    OWN(B_POL, DWRD, 6, R, NONE, 0, "8.1.1") \
    OWN(B_INK, DWRD, 6, R, NONE, 0, "8.1.1") \
    OWN(B_POL_EX, QWRD, 16, R, NONE, 0, "8.1.1") \
    OWN(B_INK_EX, QWRD, 16, R, NONE, 0, "8.1.1") \
    OWN(POSITION_POS1_EX, QWRD, 16, R, NONE, 0, "8.1.1") \
    OWN(POSITION_POS2_EX, QWRD, 16, R, NONE, 0, "8.1.1") \
    OWN(POSITION_POS3_EX, QWRD, 16, R, NONE, 0, "8.1.1") \
    OWN(POSITION_POS4_EX, QWRD, 16, R, NONE, 0, "8.1.1") \
    OWN(POSITION_POS5_EX, QWRD, 16, R, NONE, 0, "8.1.1") \
    OWN(DIFCIT_X, DWRD, 16, R, NONE, 0, "8.1.1") \
    OWN(POS_SPACE_PLC, WORD, 1, RW, NONE, 0, "8.1.1") \
    OWN(POS_SPACE_MMM, WORD, 1, RW, NONE, 0, "8.1.1") \
    OWN(PB11, BYTE, 2, R, NONE, 0, "8.1.2") \
    SAME(PB12, PB11, 1, BYTE, 1, R, "8.1.2") \
    OWN(VYSOVERS, WORD, 1, R, NONE, 0, "8.1.2") \
    OWN(REQ_SPEED_PM, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(ACT_SPEED_PM, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(ACT_SPEED2_PM, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(AVG_SPEED_PM, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(AVG_SPEED2_PM, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(REQ_SPEED_PT, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(ACT_SPEED_PT, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(ACT_SPEED2_PT, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(AVG_SPEED_PT, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(AVG_SPEED2_PT, DWRD, 1, R, NONE, 0, "8.1.2") \
    OWN(SIM_SPEED_PT, DWRD, 1, RW, NONE, 0, "8.1.2") \
    SAME(OTACKY_VR, SIM_SPEED_PT, 0, DWRD, 1, RW, "8.1.2") \
    OWN(REQW_SPEED2_PM, DWRD, 1, RW, NONE, 0, "8.1.2") \
    OWN(SPINDLE_GEAR_ACT_1, WORD, 1, RW, NONE, 1, "8.1.3") \
    OWN(EXT_FEED_AUTMAN, WORD, 1, RW, NONE, 0, "8.1.11") \
    OWN(EXT_FEED_G00_AUTMAN, WORD, 1, RW, NONE, 0, "8.1.11") \
    OWN(BZH13, BYTE, 1, R, NONE, 0, "8.1.18") \
    OWN(BZH09, BYTE, 2, RW, NONE, 0, "8.1.19") \
    SAME(BZH10, BZH09, 1, BYTE, 1, RW, "8.1.19") \
    OWN(FEED_OVR_MULTIPLIER, WORD, 1, RW, NONE, 1000, "8.1.19") \
    OWN(SPEED_OVR_EXT, WORD, 1, RW, NONE, 0, "8.1.20") \
    OWN(SPEED_OVR_MULTIPLIER, WORD, 1, RW, NONE, 1000, "8.1.20") \
    OWN(STATUS_RESTART, BYTE, 1, R, NONE, 0, "8.1.22") \
    OWN(HOMING, WORD, 1, RW, NONE, 0, "8.1.23") \
    OWN(HOMING_REQ, WORD, 1, RW, NONE, 0, "8.1.23") \
    OWN(HOMING_START_REQ, WORD, 1, RW, NONE, 0, "8.1.23") \
    OWN(REFPOINT_DIST, QWRD, 16, RW, NONE, 0, "8.1.23") \
    OWN(SLS_REFER, WORD, 1, RW, NONE, 0, "8.1.23") \
    OWN(NlcAxisEnable, WORD, 1, RW, NONE, 0, "8.1.23") \
    OWN(NlcServoEnable, WORD, 1, RW, NONE, 0xFFFF, "8.1.23") \
    OWN(PB03, BYTE, 1, R, NONE, 0, "8.2.5") \
    OWN(PB05, BYTE, 1, R, NONE, 0, "8.2.5") \
    OWN(PB06, BYTE, 1, R, NONE, 0, "8.2.5") \
    OWN(PB07, BYTE, 4, R, NONE, 0, "8.2.5") \
    SAME(PB08, PB07, 1, BYTE, 1, R, "8.2.5") \
    SAME(PB09, PB07, 2, BYTE, 1, R, "8.2.5") \
    SAME(PB10, PB07, 3, BYTE, 1, R, "8.2.5") \
    OWN(PB13, BYTE, 1, R, NONE, 0, "8.2.5") \
    OWN(PB14, BYTE, 1, R, NONE, 0, "8.2.5") \
    OWN(PB15, BYTE, 1, R, NONE, 0, "8.2.5") \
    OWN(PB16, BYTE, 1, R, NONE, 0, "8.2.5") \
    OWN(CNT_NEXT_BLOCKS, WORD, 1, R, NONE, 0, "8.3.2") \
    OWN(LIMIT_FEED, DWRD, 1, RW, NONE, 0, "8.4.1") \
    OWN(LIMIT_FEED_G00, DWRD, 1, RW, NONE, 0, "8.4.1") \
    OWN(SYST_TIME_INFO, STRUCTURE, 4, R, TIME, 0, "8.4.2") \
    OWN(UTC_TIME_INFO, STRUCTURE, 4, R, TIME, 0, "8.4.2") \
    OWN(SYST_DATE_INFO, STRUCTURE, 4, R, DATE, 0, "8.4.2") \
    OWN(UTC_DATE_INFO, STRUCTURE, 4, R, DATE, 0, "8.4.2") \
    OWN(FILETIME_INFO, STRUCTURE, 8, R, FILETIME, 0, "8.4.2") \
    OWN(PTLTOC_P1, WORD, 1, R, NONE, 0, "8.4.3") \
    OWN(PTLTOC_P1_2, WORD, 1, R, NONE, 0, "8.4.3") \
    OWN(PTLTOC_P2, WORD, 1, R, NONE, 0, "8.4.3") \
    OWN(PTLTOC_P2_2, WORD, 1, R, NONE, 0, "8.4.3") \
    OWN(DISPTOC1, BYTE, 8, RW, DISPLAY, 0, "8.4.3") \
    OWN(DISPTOC2, BYTE, 8, RW, DISPLAY, 0, "8.4.3") \
    OWN(TIME_DIST, DWRD, 1, R, NONE, 0, "8.4.4") \
    OWN(PLC_MEM_BACKUP, BYTE, 10000, RW, NONE, 0, "8.4.5") \
    OWN(dwAxNCAcceleration, DWRD, 16, R, NONE, 0, "8.4.6") \
    OWN(dwAxNCAccelerationRT, DWRD, 16, R, NONE, 0, "8.4.6") \
    OWN(dwAxNCAccelerationEmergency, DWRD, 16, R, NONE, 0, "8.4.6") \
    OWN(rAxNCParabAccel, REAL, 16, R, NONE, 0, "8.4.6") \
    OWN(rAxNCParabAccelRT, REAL, 16, R, NONE, 0, "8.4.6") \
    OWN(rAxNCParabAccelEmergency, REAL, 16, R, NONE, 0, "8.4.6") \
    OWN(dwAxNCLinearAccel, DWRD, 16, R, NONE, 0, "8.4.6") \
    OWN(dwAxNCLinearAccelRT, DWRD, 16, R, NONE, 0, "8.4.6") \
    OWN(dwAxNCLinearAccelEmergency, DWRD, 16, R, NONE, 0, "8.4.6") \
    OWN(dwAxNcFeed, DWRD, 16, R, NONE, 0, "8.4.6") \
    OWN(dwAxNcFeedRT, DWRD, 16, R, NONE, 0, "8.4.6") \
    OWN(rAxGParabAccel, REAL, 1, RW, NONE, 0, "8.4.6") \
    OWN(dwAxGLinearAccel, DWRD, 1, RW, NONE, 0, "8.4.6") \
    OWN(PLC_PASS, BYTE, 1, R, NONE, 0, "own") \
    OWN(PLC_ERROR, DWRD, 1, R, NONE, 0, "own")

/* ONE(name, access, preset, section): a bit. AXES(name, count, access, preset, section): a bit of each of the first axes, whose
 * name stands in the place of x. NUMBERED(name, first, count, access, section): bits with a number in the place of n. */
#define CNC_BITS(ONE, AXES, NUMBERED) \
    AXES(MPxPI, 16, RW, 1, "8.1.4") \
    AXES(MPxMAN, 16, RW, 1, "8.1.5") \
    AXES(MPx, 6, R, 0, "8.1.6") \
    AXES(PO_OSxPI, 16, R, 0, "8.1.7") \
    AXES(PO_OSx, 6, R, 0, "8.1.7") \
    AXES(SM_POxPI, 16, R, 0, "8.1.8") \
    AXES(VAZBA_x, 16, RW, 1, "8.1.9") \
    AXES(POLOHV_x, 16, RW, 0, "8.1.10") \
    AXES(EXM_x0, 16, RW, 0, "8.1.11") \
    AXES(EXM_x1, 16, RW, 0, "8.1.11") \
    AXES(KRx, 16, RW, 0, "8.1.23") \
    AXES(KRRx, 16, RW, 0, "8.1.23") \
    AXES(ZPRx, 16, RW, 0, "8.1.23") \
    AXES(KHx0, 16, RW, 0, "8.1.24") \
    AXES(KHx1, 16, RW, 0, "8.1.24") \
    AXES(ZPx0, 16, RW, 0, "8.1.24") \
    AXES(ZPx1, 16, RW, 0, "8.1.24") \
    ONE(REQ_EXT_SPINDLE_GEAR, RW, 0, "8.1.3") \
    ONE(REQ_MAN_SPINDLE_GEAR, RW, 0, "8.1.3") \
    ONE(ACK_AUTMAN, R, 0, "8.1.11") \
    ONE(INPOS_STOP, R, 0, "8.1.11") \
    ONE(EN_AUTMAN, RW, 1, "8.1.11") \
    ONE(AUTMAN_CONT_NC, R, 0, "8.1.11") \
    ONE(AUTMAN_CONT_TOC, R, 0, "8.1.11") \
    ONE(AUTMAN_CONT_SELECT, R, 0, "8.1.11") \
    ONE(AUTMAN_CONT_G00, R, 0, "8.1.11") \
    ONE(AUTMAN_REQ, RW, 0, "8.1.11") \
    ONE(REQ_EXT_CONT_AUTMAN, RW, 0, "8.1.11") \
    ONE(REQ_EXT_SELECT_AUTMAN, RW, 0, "8.1.11") \
    ONE(REQ_EXT_FEED_AUTMAN, RW, 0, "8.1.11") \
    ONE(REQ_EXT_G00_AUTMAN, RW, 0, "8.1.11") \
    ONE(STOPPI, RW, 0, "8.1.12") \
    ONE(STOP_REQ, RW, 0, "8.1.12") \
    ONE(STOP_EMERGENCY_REQ, RW, 0, "8.1.12") \
    ONE(START_DISABLE, RW, 0, "8.1.13") \
    ONE(START_SUSPEND, RW, 0, "8.1.13") \
    ONE(PO_F, R, 0, "8.1.14") \
    ONE(PO_POL, R, 0, "8.1.15") \
    ONE(PO_STOP, R, 0, "8.1.16") \
    ONE(INPOS, R, 0, "8.1.17") \
    ONE(FEED_OVR, RW, 0, "8.1.19") \
    ONE(SPEED_OVR, RW, 0, "8.1.20") \
    ONE(PRODLEVA, RW, 0, "8.1.21") \
    ONE(BLOCK_RESTART, R, 0, "8.1.22") \
    ONE(HOMING_SINGLE, RW, 0, "8.1.23") \
    ONE(HOMING_PLC, RW, 0, "8.1.23") \
    ONE(HOMING_GROUP, RW, 0, "8.1.23") \
    ONE(AUTPI, R, 0, "8.2.2") \
    ONE(REFPI, R, 0, "8.2.2") \
    ONE(CAPI, R, 0, "8.2.2") \
    ONE(G33PI, R, 0, "8.2.3") \
    ONE(G00PI, R, 0, "8.2.4") \
    ONE(ZMSHPI, R, 0, "8.2.6") \
    ONE(ZMSTPI, R, 0, "8.2.6") \
    NUMBERED(ZMMnPI, 1, 14, R, "8.2.6") \
    ONE(M00_PID, R, 0, "8.2.7") \
    ONE(M01_PID, R, 0, "8.2.7") \
    ONE(M02_PID, R, 0, "8.2.7") \
    ONE(M30_PID, R, 0, "8.2.7") \
    ONE(M03PI, R, 0, "8.2.8") \
    ONE(M04PI, R, 0, "8.2.8") \
    ONE(M19PI, R, 0, "8.2.8") \
    ONE(M41PI, R, 0, "8.2.9") \
    ONE(M42PI, R, 0, "8.2.9") \
    ONE(M43PI, R, 0, "8.2.9") \
    ONE(M44PI, R, 0, "8.2.9") \
    ONE(M07PI, R, 0, "8.2.10") \
    ONE(M08PI, R, 0, "8.2.10") \
    ONE(M50PI, R, 0, "8.2.11") \
    ONE(M51PI, R, 0, "8.2.11") \
    ONE(M10PID, R, 0, "8.2.12") \
    ONE(M11PID, R, 0, "8.2.12") \
    ONE(M06PID, R, 0, "8.2.13") \
    ONE(M60PI, R, 0, "8.2.13") \
    ONE(SF_RUN, R, 0, "8.3.6") \
    ONE(SF_BLOCKINPROGR, R, 0, "8.3.6") \
    ONE(SF_BLOCKFINISHED, R, 0, "8.3.6") \
    ONE(SF_STOP, R, 0, "8.3.6") \
    ONE(SF_NOTINPOS, R, 0, "8.3.6") \
    ONE(SF_DELAYINPROGR, R, 0, "8.3.6") \
    ONE(SF_INDICATIONMODE, R, 0, "8.3.6") \
    ONE(SF_SIMULATIONMODE, R, 0, "8.3.6") \
    ONE(SF_HIGHSPEEDMODE, R, 0, "8.3.6") \
    ONE(SF_CONDSTOPMODE, R, 0, "8.3.6") \
    ONE(SF_MANUALMODE, R, 0, "8.3.6") \
    ONE(SF_BLOCKBYBLOCK, R, 0, "8.3.6") \
    ONE(SF_LS, R, 0, "8.3.6") \
    ONE(SF_SLS, R, 0, "8.3.6") \
    ONE(SF_BACKWARD, R, 0, "8.3.6") \
    ONE(SF_STOPPOSCHANGED, R, 0, "8.3.6") \
    ONE(LIMIT_FEED_REQ, RW, 0, "8.4.1") \
    ONE(LIMIT_FEED_G00_REQ, RW, 0, "8.4.1") \
    ONE(BUSY_DISPTOC1, RW, 0, "8.4.3") \
    ONE(BUSY_DISPTOC2, RW, 0, "8.4.3") \
    ONE(G23ACT, R, 0, "8.4.4") \
    ONE(REQ_BACKUP_MEM, RW, 0, "8.4.5") \
    ONE(REQ_PARABACCEL, RW, 0, "8.4.6") \
    ONE(REQ_LINEARACCEL, RW, 0, "8.4.6") \
    ONE(EXT_PLC, RW, 0, "own") \
    ONE(PLC_PASS_DONE, RW, 0, "own")

/* FLAG(name, section), FLAGS(name with a number from 0 on in the place of n, count, section), VALUE(name, type, count, section):
 * what is read as BLK[block].name. */
#define CNC_QUEUE(FLAG, FLAGS, VALUE) \
    FLAGS(Mn, 15, "8.3.1") \
    FLAG(FirstBlock, "8.3.1") \
    FLAG(LastBlock, "8.3.1") \
    FLAG(Stop, "8.3.1") \
    FLAG(CondStop, "8.3.1") \
    FLAG(Backward, "8.3.1") \
    FLAG(SelBlock, "8.3.1") \
    FLAG(Cont, "8.3.1") \
    FLAG(TchlOff, "8.3.1") \
    FLAG(Partial, "8.3.1") \
    FLAG(HProg, "8.3.1") \
    FLAG(TProg, "8.3.1") \
    FLAG(RevFeed, "8.3.1") \
    FLAG(ContinuousMode, "8.3.1") \
    FLAG(ConstCutSpeed, "8.3.1") \
    FLAGS(AxNCnMove, 16, "8.3.1") \
    FLAGS(IPlcn, 5, "8.3.1") \
    FLAGS(RPlcn, 5, "8.3.1") \
    VALUE(M, DWRD, 15, "8.3.3") \
    VALUE(IPlcParams, DWRD, 5, "8.3.3") \
    VALUE(T, DWRD, 1, "8.3.3") \
    VALUE(AxG, DWRD, 3, "8.3.3") \
    VALUE(H, REAL, 1, "8.3.4") \
    VALUE(RPlcParams, REAL, 5, "8.3.4") \
    VALUE(Delay, REAL, 1, "8.3.4") \
    VALUE(AxNC, REAL, 16, "8.3.4") \
    VALUE(BlockLen, REAL, 1, "8.3.4") \
    VALUE(Scale, REAL, 1, "8.3.4") \
    VALUE(FeedProgr, REAL, 1, "8.3.4") \
    VALUE(FeedMax, REAL, 1, "8.3.4") \
    VALUE(FeedCriterial, REAL, 1, "8.3.4") \
    VALUE(ParabAccel, REAL, 1, "8.3.4") \
    VALUE(LinearAccel, REAL, 1, "8.3.4") \
    VALUE(SpindleSpeed, REAL, 1, "8.3.4") \
    VALUE(SpindleSpeedLimit, REAL, 1, "8.3.4") \
    VALUE(ConstCuttingSpeed, REAL, 1, "8.3.4")

#endif
