//! The colors of the interface: text of every kind is readable on every ground that it is drawn on.

use eframe::egui::{Color32, Context, Theme, Visuals};

/// Sets the colors of both themes.
pub(crate) fn install(context: &Context) {
    for theme in [Theme::Dark, Theme::Light] {
        context.set_visuals_of(theme, visuals(theme));
    }
}

/// Returns egui's colors, with those of text changed where they are too near to their ground.
fn visuals(theme: Theme) -> Visuals {
    let mut visuals = theme.default_visuals();
    let rgb = Color32::from_rgb;
    let (text, weak, error, warning, link) = match theme {
        Theme::Dark => (
            Color32::from_gray(196),
            Color32::from_gray(160),
            rgb(255, 122, 112),
            rgb(255, 170, 60),
            rgb(110, 180, 255),
        ),
        Theme::Light => {
            (Color32::from_gray(50), Color32::from_gray(95), rgb(180, 0, 0), rgb(140, 70, 0), rgb(0, 85, 170))
        }
    };
    visuals.widgets.noninteractive.fg_stroke.color = text;
    visuals.widgets.inactive.fg_stroke.color = text;
    visuals.weak_text_color = Some(weak);
    if theme == Theme::Dark {
        visuals.code_bg_color = Color32::from_gray(40);
    }
    (visuals.error_fg_color, visuals.warn_fg_color, visuals.hyperlink_color) = (error, warning, link);
    visuals
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panel::graph::{FILLS, INK};
    use metrics::linear_from_srgb;

    /// What WCAG 2.2 asks for at level AA.
    const LEAST: f32 = 4.5;

    fn luminance(color: Color32) -> f32 {
        let [r, g, b] = [color.r(), color.g(), color.b()].map(|c| linear_from_srgb(f32::from(c) / 255.0));
        metrics::luminance([r, g, b])
    }

    /// The contrast of WCAG: of relative luminances, with 0.05 for the light of the room.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
        a.max(b) / a.min(b)
    }

    /// A color over an opaque ground.
    fn over(color: Color32, ground: Color32) -> Color32 {
        ground.blend(color)
    }

    #[test]
    fn contrast_is_that_of_wcag() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-3);
        // The grey that is given as the lightest of level AA on white.
        assert!((contrast(Color32::from_gray(0x76), Color32::WHITE) - 4.54).abs() < 0.01);
    }

    #[test]
    fn text_is_readable_on_every_ground() {
        for theme in [Theme::Dark, Theme::Light] {
            let v = visuals(theme);
            let striped = over(v.faint_bg_color, v.panel_fill);
            let grounds = [v.panel_fill, v.window_fill, striped, v.extreme_bg_color, v.code_bg_color];
            let texts = [
                ("text", v.text_color()),
                ("strong text", v.strong_text_color()),
                ("weak text", v.weak_text_color()),
                ("errors", v.error_fg_color),
                ("warnings", v.warn_fg_color),
                ("links", v.hyperlink_color),
            ];
            for (name, text) in texts {
                for ground in grounds {
                    let found = contrast(text, ground);
                    assert!(found >= LEAST, "{theme:?}: {name} on {ground:?} has {found:.2}");
                }
            }
            let w = &v.widgets;
            for (name, state) in
                [("inactive", w.inactive), ("hovered", w.hovered), ("active", w.active), ("open", w.open)]
            {
                for ground in [state.weak_bg_fill, state.bg_fill] {
                    let found = contrast(state.fg_stroke.color, over(ground, v.panel_fill));
                    assert!(found >= LEAST, "{theme:?}: {name} control has {found:.2}");
                }
            }
            let selected = contrast(v.selection.stroke.color, over(v.selection.bg_fill, v.panel_fill));
            assert!(selected >= LEAST, "{theme:?}: a selected label has {selected:.2}");
        }
    }

    #[test]
    fn boxes_of_the_graph_are_readable() {
        for (dark, inks) in [(true, INK[0]), (false, INK[1])] {
            for (name, fill) in FILLS.map(|(name, fills)| (name, fills[usize::from(!dark)])) {
                let found = contrast(inks, fill);
                assert!(found >= LEAST, "dark {dark}: {name} has {found:.2}");
            }
        }
    }
}
