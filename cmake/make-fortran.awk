# One public header as Fortran: its constants, an interface for each of its calls, or its constants in the default kind of integer.
#   awk -v pass=constants|calls|names -v title=<as the reader knows the header> -f make-fortran.awk <header>

# "text" in lines of at most 120 columns, cut at blanks
function put(indent, text,   line, cut) {
    line = indent text
    while (length(line) > 120) {
        for (cut = 118; substr(line, cut - 1, 2) !~ /[,)] /; cut--) ;
        print substr(line, 1, cut - 1) " &"
        line = indent "    " substr(line, cut + 1)
    }
    print line
}

# constants: "{ A = 0, B = 1 }"
function constants(body,   i, n, entry, value, line) {
    n = split(body, entry, ",")
    line = ""
    value = -1
    for (i = 1; i <= n; i++) {
        gsub(/[ \t]/, "", entry[i])
        if (entry[i] == "") continue
        if (split(entry[i], side, "=") == 2) value = side[2]
        else value++
        line = line (line == "" ? "" : ", ") side[1] " = " value
    }
    if (pass == "constants" && !started++) print "  ! " title
    put("  ", (pass == "names" ? "integer, parameter, public" : "integer(c_int), parameter") " :: " line)
}

# What a comment says of parameters: "x[n][3], v[n][3]: out" are arrays, "t: in" is a number. It holds until another does.
function hear(said,   list, n, word, i, p) {
    gsub(/[ \t\n]+/, " ", said)
    while (match(said, /[a-z_][a-z0-9_]*(\[[^]]*\])*(, [a-z_][a-z0-9_]*(\[[^]]*\])*)*: /)) {
        list = substr(said, RSTART, RLENGTH - 2)
        said = substr(said, RSTART + RLENGTH)
        n = split(list, word, ", ")
        for (i = 1; i <= n; i++) {
            p = word[i]
            sub(/\[.*/, "", p)
            ARRAY[p] = word[i] ~ /\[/
        }
    }
}

# A parameter of C as it is declared in Fortran, without its name; shape: what stands behind that.
function declared(type, p, dimension, stars,   kind, in_only) {
    shape = ""
    in_only = type ~ /const /
    gsub(/const /, "", type)
    if (type in CALLBACK) return "type(c_funptr), value"
    if (type in HANDLE || type == "void") {
        if (stars < 2) return "type(c_ptr), value"
        if (type_of_list) { shape = "(*)"; return "type(c_ptr), intent(in), optional" }
        return "type(c_ptr), intent(inout), optional"
    }
    kind = KIND[type]
    if (kind == "") { print title ": no Fortran for " type " " p > "/dev/stderr"; exit 1 }
    NEEDS[SHORT[type]] = 1
    if (dimension != "") shape = "(" dimension ")"
    else if (!stars) return kind ", value"
    else if (type == "char" || ARRAY[p]) shape = "(*)"
    return kind ", intent(" (in_only ? "in" : "inout") "), optional"
}

function interface_of(prototype,   head, answer, f, i, n, part, p, type, stars, dimension, words, names, list, line, imports, result_name, is_text, held, form) {
    head = prototype
    sub(/\(.*/, "", head)
    f = head
    sub(/.*[ *]/, "", f)
    answer = substr(head, 1, length(head) - length(f))
    sub(/^[^(]*\(/, "", prototype)
    sub(/\)[^)]*$/, "", prototype)
    if (prototype == "void") prototype = ""
    n = split(prototype, part, ",")
    names = ""
    split("", NEEDS)
    result_name = answer ~ /void/ ? "" : answer ~ /\*/ ? "text" : f ~ /_has$/ ? "there" : "status"
    for (i = 1; i <= n; i++) {
        p = part[i]
        gsub(/^ +| +$/, "", p)
        type = p
        stars = gsub(/\*/, " ", p)
        type_of_list = type ~ /\*const \*/
        dimension = ""
        if (match(p, /\[[^]]*\]/)) {
            dimension = substr(p, RSTART + 1, RLENGTH - 2)
            sub(/\[.*/, "", p)
            stars++
        }
        type = p
        sub(/.* /, "", p)
        sub(/ +[a-z0-9_]+$/, "", type)
        gsub(/ +/, " ", type)
        sub(/ const$/, "", type)
        names = names (names == "" ? "" : ", ") p
        if (p == result_name) result_name = "answer"
        form = declared(type, p, dimension, stars)
        FORM[i] = form
        NAME[i] = p shape
        if (form ~ /c_ptr/) NEEDS["c_ptr"] = 1
        if (form ~ /c_funptr/) NEEDS["c_funptr"] = 1
    }
    if (result_name == "text") NEEDS["c_ptr"] = 1
    else if (result_name != "") NEEDS["c_int"] = 1
    imports = ""
    for (i = 1; i <= KINDS; i++)
        if (ORDER[i] in NEEDS) imports = imports (imports == "" ? "" : ", ") ORDER[i]

    if (!started++) print "    ! " title
    else print ""
    line = (result_name == "" ? "subroutine " : "function ") f "(" names ") bind(c)"
    put("    ", line (result_name == "" ? "" : " result(" result_name ")"))
    print "      import :: " imports
    held = ""
    for (i = 1; i <= n; i++) { # neighbours of one kind share a line
        line = i > 1 && FORM[i] == FORM[i - 1] ? line ", " NAME[i] : FORM[i] " :: " NAME[i]
        if (i == n || FORM[i + 1] != FORM[i]) put("      ", line)
    }
    if (result_name != "") print "      " (result_name == "text" ? "type(c_ptr)" : "integer(c_int)") " :: " result_name
    print "    end " (result_name == "" ? "subroutine " : "function ") f
}

BEGIN {
    KIND["int"] = "integer(c_int)"
    KIND["int64_t"] = "integer(c_int64_t)"
    KIND["double"] = "real(c_double)"
    KIND["float"] = "real(c_float)"
    KIND["char"] = "character(kind=c_char)"
    SHORT["int"] = "c_int"
    SHORT["int64_t"] = "c_int64_t"
    SHORT["double"] = "c_double"
    SHORT["float"] = "c_float"
    SHORT["char"] = "c_char"
    KINDS = split("c_char c_double c_float c_funptr c_int c_int64_t c_ptr", ORDER, " ")
    split("session member joint fluid polar aero", things, " ")
    for (i in things) HANDLE["spar_" things[i]] = 1
    split("spar_log spar_fluid_solver spar_before_step", things, " ")
    for (i in things) CALLBACK[things[i]] = 1
}

/^#/ { next }
{ text = text $0 "\n" }

# Comments and statements in turn.
END {
    while (text != "") {
        sub(/^[ \t\n]+/, "", text)
        if (text == "") break
        if (substr(text, 1, 2) == "/*") {
            stop = index(text, "*/")
            hear(substr(text, 1, stop + 1))
            text = substr(text, stop + 2)
            continue
        }
        while ((stop = index(text, "/*")) && stop < index(text, ";")) # a comment within the statement
            text = substr(text, 1, stop - 1) substr(text, stop + 1 + index(substr(text, stop), "*/"))
        stop = index(text, ";")
        if (!stop) break
        statement = substr(text, 1, stop - 1)
        text = substr(text, stop + 1)
        gsub(/[ \t\n]+/, " ", statement)
        if (pass != "calls" && statement ~ /enum \{/) {
            sub(/.*\{/, "", statement)
            sub(/\}.*/, "", statement)
            constants(statement)
        } else if (pass == "calls" && statement ~ /SPAR_API /) {
            sub(/.*SPAR_API /, "", statement)
            interface_of(statement)
        }
    }
}
