//! How often each value is in a picture.

use super::colors::Channel;
use eframe::egui::{Rect, Sense, Ui, pos2, vec2};
use metrics::Image;

/// The number of bars.
const BARS: usize = 64;

/// The height of the bars \[points\].
const HEIGHT: f32 = 56.0;

/// The counts of values between the least and the greatest finite one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Histogram {
    pub(super) least: f32,
    pub(super) greatest: f32,
    counts: Vec<usize>,
    /// The number of texels that are infinite or no number.
    pub(super) not_finite: usize,
}

impl Histogram {
    /// Counts the values of a channel.
    pub(super) fn of(image: &Image, channel: Channel) -> Histogram {
        let (least, greatest) = super::colors::range(image, channel);
        let mut histogram = Histogram { least, greatest, counts: vec![0; BARS], not_finite: 0 };
        for value in image.pixels().iter().map(|pixel| channel.of(*pixel)) {
            match histogram.bar(value) {
                Some(bar) => histogram.counts[bar] += 1,
                None => histogram.not_finite += 1,
            }
        }
        histogram
    }

    /// Returns the bar of a value.
    fn bar(&self, value: f32) -> Option<usize> {
        if !value.is_finite() {
            return None;
        }
        let range = f64::from(self.greatest) - f64::from(self.least);
        let share = if range > 0.0 { (f64::from(value) - f64::from(self.least)) / range } else { 0.0 };
        Some(((share * BARS as f64) as usize).min(BARS - 1))
    }

    /// Returns the value at which a bar begins.
    fn from(&self, bar: usize) -> f32 {
        self.least + (self.greatest - self.least) * bar as f32 / BARS as f32
    }

    /// Draws the bars, on a logarithmic scale of counts: a single texel is seen beside thousands.
    pub(super) fn show(&self, ui: &mut Ui) {
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
        let most = self.counts.iter().copied().max().unwrap_or_default().max(1);
        let height = |count: usize| ((count + 1) as f32).ln() / ((most + 1) as f32).ln() * (HEIGHT - 2.0);
        let width = rect.width() / BARS as f32;
        let color = ui.visuals().weak_text_color();
        for (i, count) in self.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let left = rect.left() + width * i as f32;
            let top = rect.bottom() - height(*count);
            let bar = Rect::from_min_max(pos2(left, top), pos2(left + (width - 0.5).max(0.5), rect.bottom()));
            painter.rect_filled(bar, 0.0, color);
        }
        if let Some(at) = response.hover_pos() {
            let bar = (((at.x - rect.left()) / width).max(0.0) as usize).min(BARS - 1);
            let (from, to) = (self.from(bar), self.from(bar + 1));
            response.on_hover_text(format!("{from:.4e} to {to:.4e}: {} texels", self.counts[bar]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_texel_is_counted_once() {
        let pixel = |value: f32| [value, 0.0, 0.0, 1.0];
        let values = [0.0, 0.0, 1.0, 4.0, f32::NAN, f32::INFINITY];
        let image = Image::new(6, 1, values.map(pixel).to_vec()).unwrap();
        let histogram = Histogram::of(&image, Channel::Red);
        assert_eq!((histogram.least, histogram.greatest, histogram.not_finite), (0.0, 4.0, 2));
        assert_eq!(histogram.counts.iter().sum::<usize>(), 4);
        assert_eq!((histogram.counts[0], histogram.counts[BARS / 4], histogram.counts[BARS - 1]), (2, 1, 1));
        assert_eq!(histogram.from(BARS / 4), 1.0);
    }

    #[test]
    fn one_value_has_one_bar() {
        let image = Image::new(2, 1, vec![[7.0; 4]; 2]).unwrap();
        assert_eq!(Histogram::of(&image, Channel::Alpha).counts[0], 2);
    }
}
