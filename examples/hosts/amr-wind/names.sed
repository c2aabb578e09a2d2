# AMR-Wind is called Kynema-SGF since April 2026: its names that our files use, as they are there.
s|"amr-wind/|"src/|g
s|amr-wind/wind_energy|src/wind_energy|g
s|amr_wind|kynema_sgf|g
s|AMR_WIND|KYNEMA_SGF|g
s|AMR-Wind|Kynema-SGF|g
