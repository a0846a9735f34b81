//! Edits the text of a lock file. Comments and the order of tables are kept.

use std::path::Path;

use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, Value, value};

use super::{
    lock_error::{LockFileError, VERSION, syntax},
    lock_file::parse,
    pin::{ExportPin, Pin},
};
use ltcforge_files::recipe_document;

/// Rewrites the text of a lock file in the current version, with exactly these pins. A table that `text` already has
/// keeps its position and its comments. An empty `text` becomes a new lock file.
///
/// # Errors
/// When `text` is not a lock file or the result would not be one, a pin is incomplete, or a path is not UTF-8.
pub fn with_pins(text: &str, pins: &[Pin]) -> Result<String, LockFileError> {
    let mut document: DocumentMut = text.parse().map_err(syntax)?;
    if !document.is_empty() {
        parse(text)?;
    }
    set(&mut document, "version", i64::from(VERSION).into());
    let tables = document.entry("table").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
    let Some(tables) = tables.as_array_of_tables_mut() else {
        return Err(LockFileError::Syntax("tables are written as [[table]]".into()));
    };
    tables.retain(|table| pins.iter().any(|pin| name_of(table) == Some(&pin.name)));
    for pin in pins {
        let present = tables.iter().position(|table| name_of(table) == Some(&pin.name));
        if let Some(table) = present.and_then(|index| tables.get_mut(index)) {
            fill(table, pin)?;
        } else {
            let mut table = Table::new();
            fill(&mut table, pin)?;
            tables.push(table);
        }
    }
    let text = document.to_string();
    parse(&text)?;
    Ok(text)
}

fn name_of(table: &Table) -> Option<&str> {
    table.get("name").and_then(Item::as_str)
}

fn fill(table: &mut Table, pin: &Pin) -> Result<(), LockFileError> {
    let incomplete = |field| LockFileError::Incomplete { name: pin.name.clone(), field };
    let recipe = pin.recipe.as_deref().ok_or_else(|| incomplete("recipe"))?;
    let read = recipe_document::parse_any_stored(recipe.as_bytes())
        .map_err(|source| LockFileError::Recipe { name: pin.name.clone(), source })?;
    set(table, "name", pin.name.as_str().into());
    set(table, "path", path(&pin.path)?);
    set(table, "digest", pin.digest.to_string().into());
    set(table, "bytes", bytes(pin.bytes.ok_or_else(|| incomplete("bytes"))?)?);
    set(table, "recipe_digest", recipe_document::digest(&read).to_string().into());
    set(table, "recipe", recipe.into());
    table.remove("server");
    if pin.sources.is_empty() {
        table.remove("sources");
    } else {
        set(table, "sources", pin.sources.iter().map(ToString::to_string).collect::<Array>().into());
    }
    table.remove("export");
    if !pin.exports.is_empty() {
        let mut exports = ArrayOfTables::new();
        for export in &pin.exports {
            exports.push(export_table(export)?);
        }
        table.insert("export", Item::ArrayOfTables(exports));
    }
    Ok(())
}

fn export_table(pin: &ExportPin) -> Result<Table, LockFileError> {
    let ExportPin { engine, layout, container, precision, to, file } = pin;
    let mut table = Table::new();
    for (key, text) in [("for", engine), ("layout", layout), ("container", container), ("precision", precision)] {
        if let Some(text) = text {
            table.insert(key, value(text));
        }
    }
    table.insert("to", value(path(to)?));
    let mut files = Array::new();
    for pin in file {
        let mut file = InlineTable::new();
        file.insert("path", path(&pin.path)?);
        file.insert("bytes", bytes(pin.bytes)?);
        file.insert("digest", pin.digest.to_string().into());
        // Each file has its own line, so that a diff shows which file changed.
        files.push_formatted(Value::from(file).decorated("\n    ", ""));
    }
    files.set_trailing("\n");
    files.set_trailing_comma(true);
    table.insert("file", value(files));
    Ok(table)
}

/// Sets a value, and keeps the comment after the old value.
fn set(table: &mut Table, key: &str, new: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            let decor = old.decor().clone();
            *old = new;
            *old.decor_mut() = decor;
        }
        None => {
            table.insert(key, value(new));
        }
    }
}

fn path(path: &Path) -> Result<Value, LockFileError> {
    path.to_str().map(Into::into).ok_or_else(|| LockFileError::NotText(path.display().to_string()))
}

fn bytes(bytes: u64) -> Result<Value, LockFileError> {
    i64::try_from(bytes).map(Into::into).map_err(|_| LockFileError::Bytes(bytes))
}
