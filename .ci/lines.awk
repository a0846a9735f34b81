# Counts the lines of code of each crate, without comments, blank lines and tests: items under `#[cfg(test)]` and the files
# that only such an item includes, unless the program has their text. It reads the files twice: `awk -f lines.awk FILES pass=2 FILES`.

FNR == 1 {
    item = to_end = 0
    module = FILENAME
    if (!sub(/\/(mod|lib|main)\.rs$/, "", module)) sub(/\.rs$/, "", module)
    depth = split(FILENAME, part, "/")
    crate = depth > 2 && part[2] != "library" ? part[2] : "ltcforge"
    is_test = 0
    for (above = FILENAME in texts ? "" : module; above ~ /\//; sub(/\/[^\/]*$/, "", above)) if (above in tests) is_test = 1
}

match($0, /include_str!\("[^"\/]*\.rs"\)/) {
    folder = FILENAME
    sub(/[^\/]*$/, "", folder)
    texts[folder substr($0, RSTART + 14, RLENGTH - 16)]
}
/^#\[cfg\(((any|all)\()?test/ { item = 1 }
# Tests within a file are at its end.
item && /^(pub(\([a-z]+\))? )?mod [a-z_0-9]+ \{/ { to_end = 1 }
item && /^(pub(\([a-z]+\))? )?mod [a-z_0-9]+;/ {
    name = $0
    sub(/;.*/, "", name)
    sub(/.* /, "", name)
    tests[module "/" name] = 1
}
item {
    if (/^[^ \t#].*[;}]$/ || /^}$/) item = 0
    next
}

pass == 2 && !is_test && !to_end && !/^[ \t]*(\/\/|$)/ { lines[crate]++; all++ }

END {
    for (crate in lines) printf "%6d %s\n", lines[crate], crate | "sort -rn"
    close("sort -rn")
    printf "%6d fit and light\n%6d all\n", lines["fit"] + lines["light"], all
}
