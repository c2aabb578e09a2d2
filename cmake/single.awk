# The module spar for hosts in single precision: to each procedure that takes real(c_double) others that take real(c_float), behind
# the same generic name.
#   awk -f single.awk <the module in double precision, twice>
# All arrays of a call are of one kind, and all its single numbers; any of the four pairs will do. Arguments are converted on
# their way; where the module has the procedure for arrays of real(c_float) already, NAME_f32, nothing is. A result that the
# library leaves alone (a refused call, room behind the last entry) stays as it was.
#
# Fortran tells two procedures of a generic apart by an argument that must be there. Where all that change are optional, there is
# one procedure for each to be the first that is there: those before it are of a type that no host has.

# "text" in lines of at most 120 columns, cut behind commas and brackets
function put(indent, text,   line, cut) {
    line = indent text
    while (length(line) > 120) {
        for (cut = 118; substr(line, cut - 1, 2) !~ /[,)] /; cut--) ;
        made = made substr(line, 1, cut - 1) " &\n"
        line = indent "    " substr(line, cut + 1)
    }
    made = made line "\n"
}

# "real(c_double), intent(in) :: x(3), q(4)" as what is known of each: HEAD, DIMS
function declare(text,   side, i, c, depth, word, name) {
    if (split(text, side, " :: ") != 2) return
    side[2] = side[2] ","
    for (i = 1; i <= length(side[2]); i++) {
        c = substr(side[2], i, 1)
        depth += c == "(" ? 1 : c == ")" ? -1 : 0
        if (c != "," || depth) { word = word c; continue }
        gsub(/ /, "", word)
        name = word
        sub(/\(.*/, "", name)
        HEAD[name] = side[1]
        DIMS[name] = substr(word, length(name) + 1)
        word = ""
    }
}

function is_real(name) { return HEAD[name] ~ /^real\(c_double\)/ }
function is_single_array(name) { return HEAD[name] ~ /^real\(c_float\)/ }
function maybe(name) { return HEAD[name] ~ /optional/ }
function is_result(name) { return HEAD[name] ~ /intent\(inout\)/ }

# ":,:" of as many ranks as "(3,n)" has
function colons(dims) {
    gsub(/[^,]+/, ":", dims)
    return "(" dims ")"
}

# The end of a procedure: which others it gets
function study(   i, scalars, arrays) {
    for (i = 1; i <= n; i++) {
        if (!is_real(D[i])) continue
        if (DIMS[D[i]] == "") scalars++
        else arrays++
    }
    variants = 0
    if (scalars && arrays) {
        family(1, 0)
        family(0, 1)
        family(1, 1)
    } else if (scalars || arrays) family(scalars, arrays)
}

# One variant if something that tells it apart must be there, else one for each that may be the first.
function family(scalars, arrays,   i, k) {
    for (i = 1; i <= n; i++) {
        SINGLE[i] = is_real(D[i]) && (DIMS[D[i]] == "" ? scalars : arrays)
        TELLS[i] = SINGLE[i] && (!arrays || DIMS[D[i]] != "")
        if (TELLS[i] && !maybe(D[i])) k = i
    }
    if (k) variant(0)
    else for (i = 1; i <= n; i++) if (TELLS[i]) variant(i)
}

function variant(first,   i, d, name, names, actual, locals, before, after, declared, direct, absent, head, w, kept, nobody) {
    name = P "_single_" ++variants
    ALSO[P] = ALSO[P] ", " name
    direct = (P "_f32") in KNOWN
    for (i = 1; i <= n; i++) if (is_real(D[i]) && DIMS[D[i]] != "" && !SINGLE[i]) direct = 0
    for (i = 1; i <= n; i++) {
        d = D[i]
        absent = TELLS[i] && i < first
        names = names ", " (absent ? "no_" d : d)
        if (absent) {
            declared = declared "    type(absent), intent(in), optional :: no_" d "\n"
            nobody = nobody (nobody == "" ? "" : " .or. ") "present(no_" d ")"
            continue
        }
        head = HEAD[d]
        if (SINGLE[i]) sub(/c_double/, "c_float", head)
        if (SINGLE[i] && !direct) sub(/, contiguous/, "", head)
        if (i == first) sub(/, optional/, "", head)
        declared = declared "    " head " :: " d DIMS[d] "\n"
        if (!SINGLE[i] || direct && DIMS[d] != "") w = d
        else if (!is_result(d) && (!maybe(d) || i == first)) w = "real(" d ", c_double)"
        else {
            w = "c_" d
            locals = locals "    real(c_double), allocatable :: " w (DIMS[d] == "" ? "" : colons(DIMS[d])) "\n"
            kept = made
            made = ""
            convert(d, w, maybe(d) && i != first)
            before = before made
            made = kept
            if (is_result(d)) after = after "    call take(" w ", " d ")\n"
        }
        actual = actual ", " d "=" w
    }
    names = (SELF == "" ? "" : ", self") names
    actual = (SELF == "" ? "" : ", self") actual
    put("  ", "subroutine " name "(" substr(names, 3) ")")
    made = made (SELF == "" ? "" : "    " SELF "\n") declared locals "\n" before
    if (nobody != "") put("    ", "if (" nobody ") return") # for the compiler, which warns of what is not used
    put("    ", "call " P (direct ? "_f32" : "") "(" substr(actual, 3) ")")
    made = made after "  end subroutine " name "\n\n"
}

# A result is filled first: with what it holds where it is an argument too, else with what no result is.
function convert(d, w, optional,   text, i, k) {
    text = "allocate (" w ", source=real(" d ", c_double))"
    if (is_result(d) && !((P, d) in INOUT)) {
        k = DIMS[d] == "" ? 0 : ranks(DIMS[d])
        for (i = 1; i <= k; i++) text = (i > 1 ? text ", " : "allocate (" w "(") "ubound(" d ", " i ", c_int64_t)"
        text = (k ? text ")" : "allocate (" w) ", source=untouched)"
    }
    put("    ", (optional ? "if (present(" d ")) " : "") text)
}

function ranks(dims) { return gsub(/,/, ",", dims) + 1 }

BEGIN { INOUT["session_sum", "x"] = 1 }

# Pass 1: the procedures
FNR == NR {
    line = line $0
    if (line ~ /&$/) { sub(/ *&$/, " ", line); next }
    gsub(/  +/, " ", line)
    text = line
    line = ""
    if (text ~ /^contains/) inside = 1
    if (!inside) {
        if (match(text, /=> .*/)) bound = bound substr(text, RSTART + 2) ","
        else if (text ~ /^ procedure :: [a-z0-9_]+$/) bound = bound substr(text, 14) ","
        next
    }
    sub(/ *!.*/, "", text)
    if (text ~ /^ subroutine /) {
        split("", HEAD); split("", DIMS); split("", D)
        P = text
        sub(/.*subroutine /, "", P)
        names = P
        sub(/\(.*/, "", P)
        gsub(/.*\(|\)| /, "", names)
        n = split(names, D, ",")
        reading = 1
        KNOWN[P] = 1
        next
    }
    if (reading && text ~ / :: /) { sub(/^ /, "", text); declare(text); next }
    if (reading) { # the first statement
        reading = 0
        if (bound !~ " " P ",") next
        SELF = D[1] == "self" ? HEAD["self"] " :: self" : ""
        if (D[1] == "self") { for (i = 1; i < n; i++) D[i] = D[i + 1]; n-- }
        FOUND[++found] = P
        SELVES[P] = SELF
        COUNT[P] = n
        for (i = 1; i <= n; i++) { ND[P, i] = D[i]; NH[P, i] = HEAD[D[i]]; NS[P, i] = DIMS[D[i]] }
    }
    next
}

# Pass 2: the file with them
FNR == 1 {
    for (f = 1; f <= found; f++) {
        P = FOUND[f]
        n = COUNT[P]
        SELF = SELVES[P]
        for (i = 1; i <= n; i++) { D[i] = ND[P, i]; HEAD[D[i]] = NH[P, i]; DIMS[D[i]] = NS[P, i] }
        study()
    }
}

/^    procedure :: [a-z0-9_]+ => / && ($5 in ALSO) {
    kept = made
    made = ""
    put("    ", "procedure, private :: " $5 ALSO[$5])
    put("    ", "generic :: " $3 " => " $5 ALSO[$5])
    printf "%s", made
    made = kept
    next
}
/^    generic :: / {
    list = $0
    sub(/.*=> /, "", list)
    k = split(list, each, /, /)
    more = ""
    for (i = 1; i <= k; i++) more = more ALSO[each[i]]
    if (more != "") {
        kept = made
        made = ""
        put("    ", "procedure, private :: " substr(more, 3))
        put("    ", substr($0, 5) more)
        printf "%s", made
        made = kept
        next
    }
}
/^    procedure :: [a-z0-9_]+$/ && ($3 in ALSO) { print $0 ALSO[$3]; next }
/^ *! single precision$/ { printf "  ! Written by cmake/make-bindings.sh.\n\n%s", substr(made, 1, length(made) - 1); next }
{ print }
