"""Words of APT, ISO 4343 and of the CAM systems' CL files that move nothing, or surely do.

A word that is in no list here and that no reader knows is refused, so that no motion is lost in
silence.
"""

from __future__ import annotations

_DISPLAY = """AUTOPS CHECK CLPRNT CLRSRF DATE DEBUG DISPLAY DISPLY DRAFT FORMAT GROUP GRPNAM ISN
LEADER LETTER LPRINT NOTE OVPLOT PAINT PARTNO PBS PENDWN PENUP PLABEL PLOT PRINT REMARK SSPEED SYN
TITLE TITLES VERIFY"""
_TOLERANCE = """ARCOUT ASLOPE CLDIST CUTDIR DNTCUT CUT FLOAT INTCOD INTOL LINTOL MAXDPM MAXVEL
MCHFIN MCHTOL OUTTOL PREGEO PSIS SLOWDN SPMIL TLLFT TLOFPS TLONPS TLRGT TOLER ZSURF"""
_MACHINE = """AIR BOUNDARY BREAK CATMAT CHANNEL CHUCK CLAMP CLEARP COMPON COUPLE END END-OF-PATH
FINI HEAD HOLDER LIMIT MACHIN MATERIAL MFGNO MULTAX NOPOST OPERATION OPTION PITCH PIVOTZ
POSTN PPFUN PROGRAM RESERV REWIND RTRCTO SAFETY SAFPOS SEQNO SET SMOOTH START STOCK TLSPEC
TMARK TOOL UNCLAMP UNIT UNITS VOCABF CSI_SET_FLUTE_LENGTH CSI_SET_EXTENSION_LENGTH"""
_MOVING = """ARCDAT ARCMOV ARCSLP CALL COPY DEFSUB ENDSUB GOBACK GOCLER GODOWN GOLFT
GORGT GOUP INDEX MACRO MOVBLK POCKET RETRCT ROTABL ROTATE ROTHED SCURVE SMIL TERMAC THREAD UMACRO"""

IGNORED = frozenset(f"{_DISPLAY} {_TOLERANCE} {_MACHINE}".split())
"""what the listing, the tolerances of the CAM and the machine around the tool are told"""
_ORDERS = """AUXFUN INSERT LOCK OPSKIP POWER PREFUN SWITCH UNLOCK"""
MACHINE_CODE = frozenset(_ORDERS.split())
"""orders to one machine in its own language: what they do there, whether blocks are left out, which
corrector is taken, is not known here"""
CALLS = frozenset(("CALSUB",))
"""programs of the control, by their name"""
MOVING = frozenset(_MOVING.split())
"""they move the tool or the part, and are not read"""
STEERED = frozenset(("TLLFT", "TLRGT", "TLONPS", "TLOFPS"))
"""on which side of a curve the tool goes; with a motion behind a comma: TLLFT,GORGT/L1,PAST,L2"""
TURNING = frozenset(("ROTABL", "ROTATE", "ROTHED"))
"""they turn a table or head; by zero they move nothing"""
