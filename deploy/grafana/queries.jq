# The queries of the panels as rules for promtool. Any word replaces a variable of the dashboard, a duration replaces one of
# Grafana.
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
