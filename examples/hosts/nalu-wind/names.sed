# Nalu-Wind is called Kynema-UGF since April 2026: its names that our lines and files use, as they are there.
s/NALU_USES_KYNEMA/KYNEMA_UGF_USES_KYNEMA_FMB/g
s/NALU_USES_/KYNEMA_UGF_USES_/g
s/ENABLE_KYNEMA_SIXDOF/ENABLE_KYNEMA_FMB_SIXDOF/g
s/KynemaSixDof/KynemaFMBSixDof/g
s/kynema_six_dof/kynema_fmb_six_dof/g
s/nalu_fsi_accumulated_time/kynema_ugf_fsi_accumulated_time/g
s/namespace nalu/namespace kynema_ugf/g
s/sierra::nalu/sierra::kynema_ugf/g
s/(nalu /(${kynema_ugf_lib_name} /g
s/Nalu-Wind/Kynema-UGF/g
