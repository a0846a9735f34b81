# The queries of a dashboard's panels as rules that promtool parses, with Grafana's variables in place of their names: those of the
# dashboard, of which any word will do, and the built-in ones, which are durations.
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
