# The last whole cycle of a run: mean, amplitude, frequency of every column of history.csv that is a motion or a force.
# The cycle is that of the displacement which swings most in the last third of the run: from one upward passage of its
# middle to the next; a passage counts after an excursion of a tenth of the swing to the other side.
# Prints rows: column, mean, amplitude, frequency in Hz, change of the amplitude since the cycle before in per cent, amplitude of the whole
# last third. Without two passages there is no cycle, and the frequency is 0.
BEGIN { FS = "," }
FNR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /^[uf][xyz]/) { column[++columns] = i; name[columns] = $i }; next }
{
    lines++; t[lines] = $1
    for (c = 1; c <= columns; c++) x[c, lines] = $column[c]
}
function range(c, from, to,   i) {
    least = most = x[c, from]
    for (i = from; i <= to; i++) { if (x[c, i] > most) most = x[c, i]; if (x[c, i] < least) least = x[c, i] }
    return most - least
}
END {
    if (lines < 3) exit 1
    from = int(lines * 2 / 3); if (from < 1) from = 1
    for (c = 1; c <= columns; c++)
        if (name[c] ~ /^u/) { swing = range(c, from, lines); if (swing > largest) { largest = swing; main = c } }
    if (main) {
        range(main, from, lines); middle = (most + least) / 2; low = middle - (most - least) / 10
        for (i = from; i < lines; i++) {
            if (x[main, i] < low) armed = 1
            if (armed && x[main, i] < middle && x[main, i + 1] >= middle) {
                armed = 0; up[++ups] = i
                when[ups] = t[i] + (t[i + 1] - t[i]) * (middle - x[main, i]) / (x[main, i + 1] - x[main, i])
            }
        }
    }
    f = ups > 1 ? 1 / (when[ups] - when[ups - 1]) : 0
    for (c = 1; c <= columns; c++) {
        third = range(c, from, lines) / 2
        change = 0
        if (ups > 2) { before = range(c, up[ups - 2], up[ups - 1]) }
        if (ups > 1) swing = range(c, up[ups - 1], up[ups]); else swing = range(c, from, lines)
        if (ups > 2 && before > 0) change = 100 * (swing / before - 1)
        printf "%s %.10g %.10g %.6g %.3g %.6g\n", name[c], (most + least) / 2, (most - least) / 2, f, change, third
    }
}
