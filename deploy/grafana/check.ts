// What `make lint-deploy` holds ltcforge.json to: Grafana's own types, and what every panel of ours has. A field with another name
// is refused too, since the dashboard is checked as a literal.
import type { Dashboard, DataQuery, FieldConfig, GridPos, Panel } from '@grafana/schema';
import type { FieldConfig as Lines } from '@grafana/schema/dist/esm/raw/composable/timeseries/panelcfg/x/TimeSeriesPanelCfg_types.gen';

interface Source {
  type: 'prometheus';
  uid: '${datasource}';
}

interface Query extends DataQuery {
  datasource: Source;
  expr: string;
  legendFormat: string;
}

// Grafana leaves the queries of a panel to its data source.
interface Graph extends Omit<Panel, 'targets'> {
  id: number;
  type: 'timeseries';
  title: string;
  description: string;
  datasource: Source;
  gridPos: GridPos;
  fieldConfig: { defaults: FieldConfig<Lines> & { unit: string }; overrides: [] };
  targets: Query[];
}

export interface Checked extends Omit<Dashboard, 'panels'> {
  uid: string;
  title: string;
  panels: Graph[];
}
