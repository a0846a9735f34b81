// `make lint-deploy` checks ltcforge.json against these types: Grafana's own types, and the fields that each panel must
// have. The dashboard is checked as a literal, so an unknown field is an error.
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

// Grafana leaves the type of queries to the data source.
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
