# Prints the queries of the panels as rules for promtool. An arbitrary word replaces each dashboard variable, and a
# duration replaces each Grafana variable.
(.templating.list | map(.name)) as $names
| { groups: [{ name: "panels", rules: [
    .panels[] | "panel_\(.id)" as $panel | .targets[] | {
      record: "\($panel):\(.refId)",
      expr: (.expr
        | gsub("\\$(\\{(?<a>\\w+)\\}|(?<b>\\w+))"; (.a // .b) as $name
          | if $name | startswith("__") then "5m"
            elif $names | index($name) then "x"
            else error("\($panel): the dashboard has no variable «\($name)»") end))
    }
  ] }] }
