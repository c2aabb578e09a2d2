# A public header as a table, for the scripts that write it in other languages; fields are parted by tabs:
#   constants  NAME=number ...                           of one enumeration
#   call  name  int|text|none  name|type|pass|shape ...  and its parameters
#   collective  name                                     whose comment has the word "Collective"; the others are local
# type: int, int64_t, double, float, char, context, the callback's or the handle's (session, member, ...). pass: value, in or out
# (by address), list (of handles, in), callback. shape: [n][3], "" of a single number.
# Whether an address is an array's, the comments say: "x[n][3]: out" is one, "t: out" a single number; what is said of a name
# holds until something else is. A capacity has the constant that counts its entries: "report[capacity]: out, by SPAR_REPORT_*".
# With -v null=1 each parameter has a fifth part: null, where its comment says what NULL means.
# With -v docs=1 each call is followed by:
#   doc  name  the comment before it, a backslash and an n between its lines
#   awk -f interface.awk <header>

function hear(said,   list, n, word, i, p, own, each) {
    gsub(/[ \t\n]+/, " ", said)
    each = said ~ /each NULL/
    while (match(said, LIST)) {
        list = substr(said, RSTART, RLENGTH - 2)
        said = substr(said, RSTART + RLENGTH)
        n = split(list, word, ", ")
        for (i = 1; i <= n; i++) {
            p = word[i]
            sub(/\[.*/, "", p)
            SHAPE[p] = substr(word[i], length(p) + 1)
            if (said ~ /^out, (m, rad, )?by SPAR_/) SHAPE[p] = counted(SHAPE[p], said)
            own = said
            if (match(own, LIST)) own = substr(own, 1, RSTART - 1)
            NULL[p] = each || own ~ /NULL/
        }
    }
}

# "[capacity]" by "SPAR_REPORT_*"
function counted(shape, said,   by) {
    sub(/^[^S]*/, "", said)
    while (match(said, /^SPAR_[A-Z_]+\*/)) {
        by = substr(said, 1, RLENGTH - 1) "COUNT"
        said = substr(said, RLENGTH + 1)
        sub(/\[[a-z]+\]/, "[" by "]", shape)
        if (!sub(/^ and /, "", said)) break
    }
    return shape
}

function constants(body,   i, n, entry, side, value, line) {
    n = split(body, entry, ",")
    line = "constants"
    value = -1
    for (i = 1; i <= n; i++) {
        gsub(/[ \t]/, "", entry[i])
        if (entry[i] == "") continue
        value = split(entry[i], side, "=") == 2 ? side[2] : value + 1
        line = line "\t" side[1] "=" value
    }
    print line
}

# "const double g[3]" as "g|double|in|[3]"; the_name: "g"
function parameter(text,   type, p, stars, list, shape, fixed) {
    gsub(/^ +| +$/, "", text)
    list = text ~ /\*const \*/
    fixed = text ~ /^const /
    stars = gsub(/\*/, " ", text)
    shape = ""
    if (match(text, /\[[^]]*\]/)) {
        shape = substr(text, RSTART, RLENGTH)
        sub(/\[.*/, "", text)
        stars++
    }
    p = text
    sub(/.* /, "", p)
    the_name = p
    type = substr(text, 1, length(text) - length(p))
    gsub(/const /, "", type)
    gsub(/ +/, "", type)
    if (type == "void") return p "|context|value|"
    if (type in CALLBACK) return p "|" substr(type, 6) "|callback|"
    if (sub(/^spar_/, "", type)) return p "|" type "|" (list ? "list|[n]" : stars > 1 ? "out|" : "value|")
    if (!stars) return p "|" type "|value|"
    if (shape == "") shape = SHAPE[p]
    if (type == "char" && shape == "") shape = "[]"
    return p "|" type "|" (fixed ? "in" : "out") "|" shape
}

function call(prototype,   head, f, answer, n, i, part, line) {
    head = prototype
    sub(/\(.*/, "", head)
    f = head
    sub(/.*[ *]/, "", f)
    answer = substr(head, 1, length(head) - length(f))
    line = "call\t" f "\t" (answer ~ /void/ ? "none" : answer ~ /\*/ ? "text" : "int")
    sub(/^[^(]*\(/, "", prototype)
    sub(/\)[^)]*$/, "", prototype)
    n = prototype == "void" ? 0 : split(prototype, part, ",")
    for (i = 1; i <= n; i++) {
        line = line "\t" parameter(part[i])
        if (null && part[i] ~ /[*[]/) line = line (NULL[the_name] ? "|null" : "|")
        else if (null) line = line "|"
    }
    print line
    if (collective) print "collective\t" f
    if (docs) print "doc\t" f "\t" comment
}

BEGIN { LIST = "[a-z_][a-z0-9_]*([[][^]]*[]])*(, [a-z_][a-z0-9_]*([[][^]]*[]])*)*: " }
BEGIN { split("spar_log spar_fluid_solver spar_before_step spar_progress", names, " "); for (i in names) CALLBACK[names[i]] = 1 }
/^#/ { next }
{ text = text $0 "\n" }

# Comments and statements in turn.
END {
    while (text != "") {
        sub(/^[ \t\n]+/, "", text)
        if (substr(text, 1, 2) == "/*") {
            stop = index(text, "*/")
            hear(substr(text, 1, stop + 1))
            collective = substr(text, 1, stop + 1) ~ /Collective/
            comment = substr(text, 4, stop - 5)
            gsub(/\\/, "\\\\", comment)
            gsub(/\n   /, "\\n", comment)
            gsub(/\n/, "\\n", comment)
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
        if (statement ~ /enum \{/) {
            sub(/.*\{/, "", statement)
            sub(/\}.*/, "", statement)
            constants(statement)
        } else if (sub(/.*SPAR_API /, "", statement)) {
            call(statement)
        }
    }
}
