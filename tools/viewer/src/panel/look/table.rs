//! A buffer as a table, by its struct in WGSL.

use super::scroll;
use crate::engine::{Looked, SideView};
use crate::panel::labelled;
use eframe::egui::{DragValue, Grid, RichText, Ui};
use pass::layout_of;
use shader_library::decode::{Cell, Number};

/// Rows that are shown at once.
const PAGE: usize = 64;

/// Words of a buffer that no shader declares, in a row.
const WORDS: usize = 8;

pub(super) fn show(ui: &mut Ui, side: &SideView, looked: &Looked, first: &mut usize) {
    let bound = side.plan.resource(&looked.resource).and_then(|id| layout_of(&side.steps, id));
    let Some(bound) = bound else {
        ui.weak("No shader binds it: words of 32 bits");
        words(ui, &looked.bytes, first);
        return;
    };
    let bytes = match &bound.window {
        Some(window) => looked.bytes.get(window.start as usize..window.end as usize).unwrap_or_default(),
        None => looked.bytes.as_slice(),
    };
    let table = bound.layout.table(bytes);
    ui.weak(format!("`{}: {}`, {} rows", bound.global, bound.layout.ty, table.len()));
    let header: Vec<String> =
        table.header().map(|(column, cell)| format!("{}: {}", column.name, text(&cell))).collect();
    if !header.is_empty() {
        ui.monospace(header.join("   "));
    }
    pages(ui, table.len(), first);
    scroll(ui, |ui| {
        Grid::new("rows").striped(true).show(ui, |ui| {
            ui.weak("row");
            for column in table.columns() {
                ui.label(RichText::new(&column.name).strong()).on_hover_text(&column.ty);
            }
            ui.end_row();
            for row in *first..(*first + PAGE).min(table.len()) {
                ui.weak(row.to_string());
                for cell in table.row(row) {
                    ui.monospace(text(&cell));
                }
                ui.end_row();
            }
        });
    });
}

/// Chooses which rows are shown.
fn pages(ui: &mut Ui, rows: usize, first: &mut usize) {
    *first = (*first).min(rows.saturating_sub(1));
    if rows <= PAGE {
        *first = 0;
        return;
    }
    ui.horizontal(|ui| {
        if ui.button("Back").clicked() {
            *first = first.saturating_sub(PAGE);
        }
        labelled(ui, "From row", |ui| ui.add(DragValue::new(first).range(0..=rows - 1)));
        if ui.button("On").clicked() {
            *first = (*first + PAGE).min(rows - 1);
        }
    });
}

fn words(ui: &mut Ui, bytes: &[u8], first: &mut usize) {
    pages(ui, bytes.len().div_ceil(4 * WORDS), first);
    scroll(ui, |ui| {
        Grid::new("words").striped(true).show(ui, |ui| {
            for (i, row) in bytes.chunks(4 * WORDS).enumerate().skip(*first).take(PAGE) {
                ui.weak((i * WORDS).to_string());
                for word in row.chunks_exact(4) {
                    let bits = u32::from_le_bytes([word[0], word[1], word[2], word[3]]);
                    ui.monospace(bits.to_string()).on_hover_text(format!("{:e}", f32::from_bits(bits)));
                }
                ui.end_row();
            }
        });
    });
}

fn text(cell: &Cell) -> String {
    let number = |number: &Number| match number {
        Number::F32(value) if *value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e5) => {
            format!("{value:.4e}")
        }
        Number::F32(value) => format!("{value:.5}"),
        Number::U32(value) => value.to_string(),
        Number::I32(value) => value.to_string(),
    };
    cell.0.iter().map(number).collect::<Vec<_>>().join("  ")
}
