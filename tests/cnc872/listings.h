/* SPDX-License-Identifier: MIT */
/* listings.h: the listings of the source as it prints them, with its comments in plain letters, each inside its section; what
 * stands around them (variables, the mechanism that is started, labels that are jumped to) is ours. Named by their sections. */
#ifndef LISTINGS_H
#define LISTINGS_H

/* 8.1.1: the following error of Y is watched. */
#define LISTING_8_1_1_LIMIT                                                       \
    "DATA\nLIMIT_Y DD 100\nERR_Y BIT 0\nDATA_END\nMODULE_MAIN\n"                  \
    " CLI    ;zakaz preruseni (ASM86) \n"                                         \
    " LOD DWRD.(DIFCIT_X+4) ;nacte diferenci Y \n"                                \
    " STI    ;povoleni preruseni (ASM86) \n"                                      \
    " ABS DWRD   ;absolutni hodnota DR 32 bitu \n"                                \
    " GE DWRD.LIMIT_Y ;porovnani \n"                                              \
    " JL1 ERROR_Y  ;skok na chybu \n"                                             \
    " JUM KONEC\nERROR_Y: FL 1,ERR_Y\nKONEC:\nMODULE_MAIN_END\n"

/* 8.1.1: the position of Y in um. */
#define LISTING_8_1_1_POSITION                                                    \
    "DATA\nPOLOHA_Y DD 0\nDATA_END\nMODULE_MAIN\n"                                \
    " CLI    ;zakaz preruseni (ASM86) \n"                                         \
    " LOD DWRD.(B_INK+4) ;nacte buffer inkrementu Y \n"                           \
    " AD DWRD.(B_POL+4) ;nacte buffer polohy Y \n"                                \
    " STI    ;povoleni preruseni (ASM86) \n"                                      \
    " RR CNST.3,DWRD  ;prevod na mikrony \n"                                      \
    " STO DWRD.POLOHA_Y ;zapis do polohy Y \n"                                    \
    "MODULE_MAIN_END\n"

/* 8.1.4: as printed; the text speaks of Z. */
#define LISTING_8_1_4                                                             \
    "DATA\nERROR_Z BIT 0\nDATA_END\nMODULE_MAIN\n"                                \
    " LDR ERROR_Z  ;nacte poruchovy signal \n"                                    \
    " FL1 0,MPYPI  ;podmineny zakaz pohybu \n"                                    \
    "MODULE_MAIN_END\n"

/* 8.1.7: a clamp is opened before X moves; the mechanism waits for an input. */
#define LISTING_8_1_7                                                             \
    "DATA\nVSTUP BIT 0\nDATA_END\nMODULE_BLOCK_INIT\n"                            \
    "  LDR PO_OSXPI  ;nacte pozadavek na pohyb \n"                                \
    "  JL0 NENI_POX  ;obskok, kdyz neni pohyb \n"                                 \
    "  FL 1,UVOL_X  ;start mechanizmu uvolneni osy X \n"                          \
    "  EX    ; \n"                                                                \
    "  LDR UVOL_X  ;cekani na uvolneni \n"                                        \
    "  EX1    ; \n"                                                               \
    "NENI_POX:     ; \n"                                                          \
    "MODULE_BLOCK_INIT_END\nMODULE_MAIN\n"                                        \
    "MECH_BEGIN UVOL_X\n LDR VSTUP\n EX0\nMECH_END UVOL_X\nMODULE_MAIN_END\n"

/* 8.1.8: clutches for the directions of Y. */
#define LISTING_8_1_8                                                             \
    "DATA\nSPOJ_MINUS_Y_O BIT 0\nSPOJ_PLUS_Y_O BIT 0\nKSOJ_Y_I BIT 0\nDATA_END\n" \
    "MODULE_BLOCK_INIT\n"                                                         \
    "  LDR PO_OSYPI  ;nacteni pozadavku na pohyb \n"                              \
    "  FL1 1,SPOJKA_Y  ;podminena aktivace mechanizmu SPOJKA_Y \n"                \
    "MODULE_BLOCK_INIT_END  ;konec pripravnych funkci - necekame na \n"           \
    ";dokonceni  \n"                                                              \
    "      ;mechanizmus SPOJKA_Y \n"                                              \
    "MODULE_MAIN\n"                                                               \
    "MECH_BEGIN SPOJKA_Y \n"                                                      \
    "  EX    ;zacatek pohybu na 1 pruchod \n"                                     \
    "  FL 0,MPYPI  ;zakaz pohybu \n"                                              \
    "  LDR SM_POYPI  ;nacte platny smer pohybu \n"                                \
    "  WR SPOJ_MINUS_Y_O ;nastavi zapornou spojku  log.1=minus \n"                \
    "  CA    ;negace RLO \n"                                                      \
    "  WR SPOJ_PLUS_Y_O ;nastavi kladnou spojku log.1=plus \n"                    \
    "  LDR KSOJ_Y_I  ;kontrolni vstup \n"                                         \
    "  EX0    ;cekani na sepnuti spojky \n"                                       \
    "  FL 1,MPYPI  ;povoleni pohybu \n"                                           \
    "MECH_END SPOJKA_Y   ;konec mechanizmu \n"                                    \
    "MODULE_MAIN_END\n"

/* 8.1.9: the position loop of Z is closed once its clamp is open. */
#define LISTING_8_1_9                                                             \
    "DATA\nVSTUP BIT 0\nDATA_END\n"                                               \
    "MODULE_INIT\n FL 0,VAZBA_Z\nMODULE_INIT_END\n"                               \
    "MODULE_BLOCK_INIT\n"                                                         \
    "  LDR PO_OSZPI ;pozadavek na pohyb \n"                                       \
    "  JL0 POZ_E  ;obskok \n"                                                     \
    "  FL 1,UVOL_Z ;start mechanizmu uvolnovani \n"                               \
    "  EX   ; \n"                                                                 \
    "  LDR UVOL_Z ;cekame na uvolneni \n"                                         \
    "  EX1   ; \n"                                                                \
    "  FL 1,VAZBA_Z ;zapnuti polohove vazby \n"                                   \
    "POZ_E: ;v zaverecnych funkcich bude vypnuti vazby \n"                        \
    "\n;spolecne s upnutim souradnice \n"                                         \
    "MODULE_BLOCK_INIT_END\nMODULE_MAIN\n"                                        \
    "MECH_BEGIN UVOL_Z\n LDR VSTUP\n EX0\nMECH_END UVOL_Z\nMODULE_MAIN_END\n"

/* 8.1.12: an error in the preparatory functions; what the source leaves out (......) is a jump. */
#define LISTING_8_1_12                                                            \
    "DATA\nTLAK_I BIT 0\nCITAC_TL DW 0\nCAS_ERROR DW 500\nDATA_END\n"             \
    "MODULE_BLOCK_INIT\n"                                                         \
    "  LDR TLAK_I    ;nacte vstup o tlaku \n"                                     \
    "  TEX0 CITAC_TL,CAS_ERROR,ERROR,15h ;casova kontrola tlaku \n"               \
    "  JUM DAL\n"                                                                 \
    "ERROR: ESET      ;nastaveni chyboveho hlaseni \n"                            \
    "  FL 1,STOPPI    ;STOP z PLC programu \n"                                    \
    "  EX \n"                                                                     \
    "  LDR CAPI     ;\"nekonecny stav\" \n"                                       \
    "  EX0      ;zabraneni dalsimu vykonu \n"                                     \
    "        ;pripravnych funkci \n"                                              \
    "DAL:\nMODULE_BLOCK_INIT_END\n"

/* 8.1.19: the feed override of the PLC program. */
#define LISTING_8_1_19                                                            \
    "DATA\nPROMILE DW 1500\nDATA_END\nMODULE_MAIN\n"                              \
    " FL 1,FEED_OVR  ;nastaveni pozadavku na rizeni rychlosti z PLC \n"           \
    " LOD PROMILE  ;promile pozadovane rychlosti \n"                              \
    " STO WORD.BZH09  ;zapis do BZH09 a BZH10 \n"                                 \
    "MODULE_MAIN_END\n"

/* 8.2.6: the spindle is started; the next test (SKOKM4) is ours. */
#define LISTING_8_2_6                                                             \
    "DATA\nVSTUP BIT 0\nDATA_END\nMODULE_BLOCK_INIT\n"                            \
    "  LDR ZMM2PI ;test zmenoveho signalu 2. skupiny M funkci \n"                 \
    "  JL0 VRETENO_END ;skok na konec \n"                                         \
    "  LDR M03PI  ;test funkce M03 \n"                                            \
    "  JL0 SKOKM4 ;skok na dalsi testy \n"                                        \
    "  FL 1,CW  ;start mechanizmu CW \n"                                          \
    "  EX   ; \n"                                                                 \
    "  LDR CW  ;cekani na dokonceni mechanizmu CW \n"                             \
    "  EX1   ; \n"                                                                \
    "  JUM VRETENO_END ;skok na konec \n"                                         \
    "SKOKM4:\nVRETENO_END:\nMODULE_BLOCK_INIT_END\nMODULE_MAIN\n"                 \
    "MECH_BEGIN CW\n LDR VSTUP\n EX0\nMECH_END CW\nMODULE_MAIN_END\n"

/* 8.3.2: bits of blocks; A, B, C, D say which jumps have been taken. */
#define LISTING_8_3_2                                                             \
    "DATA\nA BIT 0\nB BIT 0\nC BIT 0\nD BIT 0\nDATA_END\nMODULE_BLOCK_INIT\n"     \
    "LDR BLK[0].M3  ;nacteni zmenoveho bitu 3.skupiny M \n"                       \
    "JL1 JE_NOVA  \n"                                                             \
    "JUM DRUHY\nJE_NOVA: FL 1,A\nDRUHY:\n"                                        \
    "LDR BLK[0].M2  ;nacteni zmenoveho bitu 2.skupiny M \n"                       \
    "LA BLK[0].FirstBlock ;jen z 1. bloku programu \n"                            \
    "JL1 JE_NOVA2 \n"                                                             \
    "JUM TRETI\nJE_NOVA2: FL 1,B\nTRETI:\n"                                       \
    "LDR BLK[1].TchlOff ;Je pristi blok s vypnutou technologii ? \n"              \
    "JL1 TCH_OFF \n"                                                              \
    "JUM CTVRTY\nTCH_OFF: FL 1,C\nCTVRTY:\nMOV BX,1\n"                            \
    "LDR BLK[BX].IPlc1 ;Je zmena 2.celociselneho PLC parametru ? \n"              \
    "JL1 PLC1_CHANG  ;(ve fronte pristich bloku podle BX) \n"                     \
    "JUM KONEC\nPLC1_CHANG: FL 1,D\nKONEC:\nMODULE_BLOCK_INIT_END\n"

/* 8.3.3 and 8.3.4: whole and real numbers of blocks. */
#define LISTING_8_3_3                                                             \
    "DATA\nFUN_95 BIT 0\nJE_T BIT 0\nP3 DD 0\nM12 DW 0FFFFh\nrBunH DQ 0\n"        \
    "rSoucet DQ 0\nrDelka DQ 0\nnDelka DD 0\nDATA_END\nMODULE_BLOCK_INIT\n"       \
    "LDR BLK[0].M11   ;zmenovy bit 11.skupiny M \n"                               \
    "JL0 NENI_NOVA  \n"                                                           \
    "LOD BLK[0].M[11]  ;nacte hodnotu 11.skupiny M (DWORD)  \n"                   \
    "EQ CNST.95h   ;test na M95 \n"                                               \
    "WR FUN_95  \n"                                                               \
    "LOD BLK[0].IPlcParams[2] ;nacte 3.celociselny PLC parametr  \n"              \
    "STO P3\nLOD CNST.7\n"                                                        \
    "EQ BLK[0].WORD.T  ;porovnani s hodnotou T jako WORD  \n"                     \
    "WR JE_T\n"                                                                   \
    "LOD BLK[0].BYTE.M[12]  ;nacte hodnotu 12.skupiny M (BYTE)  \n"               \
    "STO M12\n"                                                                   \
    " LOD BLK[0].REAL.H   ;Nacte hodnotu funkce H primo \n"                       \
    " STO REAL.rBunH    ;Zapise jako realne cislo \n"                             \
    " LOD BLK[0].REAL.RPlcParams[2] ;Nacte hodnotu 3.real.parametru \n"           \
    " AD BLK[0].REAL.RPlcParams[3] ;Pripocte hodnotu 4.real.parametru \n"         \
    " STO REAL.rSoucet\nMOV BX,2\n"                                               \
    " LOD BLK[BX].REAL.BlockLen  ;Nacte delku bloku v um \n"                      \
    " STO REAL.rDelka\n STO nDelka\n"                                             \
    "NENI_NOVA:\nMODULE_BLOCK_INIT_END\n"

/* 8.4.1: the feed is limited to 1 m/min. */
#define LISTING_8_4_1                                                             \
    "MODULE_MAIN\n"                                                               \
    " LOD CNST.17 \n"                                                             \
    " STO WORD.LIMIT_FEED+2  ;naplni 17 mm/s (horni word) \n"                     \
    " FL 1,LIMIT_FEED_REQ \n"                                                     \
    "MODULE_MAIN_END\n"

/* 8.4.2: time and date; each number is kept. */
#define LISTING_8_4_2                                                             \
    "DATA\nN1 DD 0\nN2 DD 0\nN3 DD 0\nN4 DD 0\nN5 DD 0\nN6 DD 0\nN7 DD 0\n"       \
    "N8 DQ 0\nDATA_END\nMODULE_MAIN\n"                                            \
    "  LOD  BYTE.SYST_TIME_INFO.TIME_MIN  ;nacte minuty \n STO N1\n"              \
    "  LOD BYTE.SYST_TIME_INFO.TIME_HOUR  ;nacte hodiny \n STO N2\n"              \
    "  LOD BYTE.SYST_TIME_INFO.TIME_SEC  ;nacte sekundy \n STO N3\n"              \
    "  LOD  WORD.SYST_DATE_INFO.DATE_YEAR  ;nacte rok \n STO N4\n"                \
    "  LOD BYTE.SYST_DATE_INFO.DATE_DAY  ;nacte den \n STO N5\n"                  \
    "  LOD BYTE.SYST_DATE_INFO.DATE_MON  ;nacte mesic \n STO N6\n"                \
    " LOD BYTE.UTC_TIME_INFO.TIME_HOUR  ;nacte hodiny UTC \n STO N7\n"            \
    " LOD QWRD.FILETIME_INFO   ;nacte format FILETIME \n STO N8\n"                \
    "MODULE_MAIN_END\n"

/* 8.4.3: three letters on the display, their quotation marks as printed. */
#define LISTING_8_4_3                                                             \
    "MODULE_MAIN\n"                                                               \
    " FL 1, BUSY_DISPTOC1  ;zakaz obsluhy \n"                                     \
    " LOD CNST.0   ;0 pixelu pro radky \n"                                        \
    " STO BYTE.DISPTOC1.TOC_ROW \n"                                               \
    " LOD CNST.16   ;16 pixelu pro sloupce \n"                                    \
    " STO BYTE.DISPTOC1.TOC_COLUMN \n"                                            \
    " LOD CNST.\xE2\x80\x98" "A\xE2\x80\x98   ;A \n"                              \
    " STO BYTE.DISPTOC1.TOC_CHAR1 \n"                                             \
    " LOD CNST.\xE2\x80\x98" "b\xE2\x80\x98   ;b \n"                              \
    " STO BYTE.DISPTOC1.TOC_CHAR2 \n"                                             \
    " LOD CNST.\xE2\x80\x98" "c\xE2\x80\x98   ;c \n"                              \
    " STO BYTE.DISPTOC1.TOC_CHAR3 \n"                                             \
    " LOD CNST.0FFh   ;transparent \n"                                            \
    " STO BYTE.DISPTOC1.TOC_CHAR4 \n"                                             \
    " FL 0, BUSY_DISPTOC1  ;povoleni obsluhy \n"                                  \
    "MODULE_MAIN_END\n"

/* 8.4.5: the memory is saved in a mechanism. */
#define LISTING_8_4_5                                                             \
    "MODULE_INIT\n FL 1,ULOZ\nMODULE_INIT_END\nMODULE_MAIN\nMECH_BEGIN ULOZ\n"    \
    " FL 1, REQ_BACKUP_MEM  ;zadost o ulozeni na disk \n"                         \
    " EX \n"                                                                      \
    " LDR REQ_BACKUP_MEM  ;ceka na ulozeni \n"                                    \
    " EX1 \n"                                                                     \
    "MECH_END ULOZ\nMODULE_MAIN_END\n"

/* 8.4.7: a licence. */
#define LISTING_8_4_7                                                             \
    "DATA\nZAKAZ BIT 0\nDATA_END\nMODULE_MAIN\n"                                  \
    " LDR_LIC FeaturePlc1  ;nacist stav licence PLC1 \n"                          \
    " JL0  LBL_DISABLE_PLC1 ;skok, kdyz neni platna licence \n"                   \
    " JUM KONEC\nLBL_DISABLE_PLC1: FL 1,ZAKAZ\nKONEC:\nMODULE_MAIN_END\n"

#endif
