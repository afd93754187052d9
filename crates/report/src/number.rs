//! Formats numbers for readers: with no more digits than the interval justifies.

/// A mean with its interval, rounded: `(mean ± half)·10^exponent`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Measured {
    /// The mean, with a minus sign of ASCII.
    mean: String,
    /// Half the width of the 95 % interval, with the same number of decimals; `None` for a single sample.
    half: Option<String>,
    /// Power of ten, 0 for none.
    exponent: i32,
}

impl Measured {
    /// Rounds a mean to two significant digits of half its interval, but at most five of its own; without an interval, to
    /// four of its own. Uses powers of ten below 10⁻³ and from 10⁵ on.
    pub fn new(mean: f64, half: Option<f64>) -> Measured {
        let greatest = mean.abs().max(half.unwrap_or(0.0));
        let order = order(greatest);
        let exponent = if greatest > 0.0 && !(-3..5).contains(&order) { order } else { 0 };
        let scale = 10_f64.powi(-exponent);
        let (mean, half) = (mean * scale, half.map(|half| half * scale));
        let leading = order - exponent;
        let places = match half {
            Some(half) if half > 0.0 => (1 - self::order(half)).min(4 - leading),
            _ if mean.fract() == 0.0 => 0,
            _ => 3 - leading,
        };
        let places = places.clamp(0, 9) as usize;
        // An interval is never rounded to zero.
        let half = half.map(|half| if half > 0.0 { half.max(0.1_f64.powi(places as i32)) } else { 0.0 });
        let round = |value: f64| {
            let text = format!("{value:.places$}");
            // Minus zero.
            if text.trim_start_matches('-').bytes().all(|b| b == b'0' || b == b'.') {
                text.trim_start_matches('-').to_owned()
            } else {
                text
            }
        };
        Measured { mean: round(mean), half: half.map(round), exponent }
    }

    /// Formats as plain text: `1.23 ± 0.04`, `(1.2 ± 0.3)·10⁻⁵`.
    pub fn text(&self) -> String {
        let power = format!("·10{}", superscript(self.exponent));
        self.joined(|half| format!(" ± {half}"), &power).replace('-', "−")
    }

    /// Formats as HTML, with the interval in a `span` of class `half`.
    pub fn html(&self) -> String {
        let power = format!("·10<sup>{}</sup>", self.exponent).replace('-', "−");
        let mean = self.mean.replace('-', "−");
        Measured { mean, ..self.clone() }.joined(|half| format!("<span class=half> ± {half}</span>"), &power)
    }

    /// Formats for LaTeX's math mode, without dollar signs.
    pub fn latex(&self) -> String {
        self.joined(|half| format!(" \\pm {half}"), &format!(" \\cdot 10^{{{}}}", self.exponent))
    }

    fn joined(&self, interval: impl Fn(&str) -> String, power: &str) -> String {
        let mean = &self.mean;
        match (&self.half, self.exponent) {
            (None, 0) => mean.clone(),
            (None, _) => format!("{mean}{power}"),
            (Some(half), 0) => format!("{mean}{}", interval(half)),
            (Some(half), _) => format!("({mean}{}){power}", interval(half)),
        }
    }
}

/// Formats a number as it was given: `0.25`, `4096`, `1e-7`.
pub fn plain(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-4..1e9).contains(&size) => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// Formats a number with this many significant digits; integers exactly.
pub fn short(value: f64, significant: i32) -> String {
    let order = order(value.abs());
    if value.fract() == 0.0 || !value.is_finite() {
        return plain(value);
    }
    if order < -4 {
        return format!("{value:.*e}", significant.max(1) as usize - 1);
    }
    format!("{value:.*}", (significant - 1 - order).max(0) as usize)
}

/// Returns the unit in which a number of bytes is readable, and its size.
pub fn byte_unit(bytes: f64) -> (f64, &'static str) {
    let units = [(1024.0 * 1024.0 * 1024.0, "GiB"), (1024.0 * 1024.0, "MiB"), (1024.0, "KiB")];
    units.into_iter().find(|&(size, _)| bytes >= size).unwrap_or((1.0, "B"))
}

/// Returns the power of ten of the leading digit; 0 for 0.
pub fn order(value: f64) -> i32 {
    if value > 0.0 && value.is_finite() { value.log10().floor() as i32 } else { 0 }
}

/// Formats an integer in superscript digits.
pub fn superscript(number: i32) -> String {
    let digit = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => char::from_u32(0x2070 + u32::from(c as u8 - b'0')).unwrap_or(c),
    };
    number.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(mean: f64, half: Option<f64>) -> String {
        Measured::new(mean, half).text()
    }

    #[test]
    fn the_interval_decides_the_last_place() {
        assert_eq!(text(1.234_567, Some(0.0432)), "1.235 ± 0.043");
        assert_eq!(text(12_345.6, Some(78.9)), "12346 ± 79");
        assert_eq!(text(0.012_34, Some(0.5)), "0.01 ± 0.50");
        assert_eq!(text(1.234_567e-7, Some(4.32e-9)), "(1.235 ± 0.043)·10⁻⁷");
        assert_eq!(text(3.2e8, Some(1.0e7)), "(3.20 ± 0.10)·10⁸");
        assert_eq!(text(-0.000_4, Some(0.1)), "0.00 ± 0.10");
    }

    #[test]
    fn five_digits_at_most_and_no_interval_is_rounded_to_nothing() {
        assert_eq!(text(1.234_567, Some(1e-9)), "1.2346 ± 0.0001");
        assert_eq!(text(1.25, Some(0.0)), "1.250 ± 0.000");
    }

    #[test]
    fn single_samples_have_four_digits() {
        assert_eq!(text(0.123_456, None), "0.1235");
        assert_eq!(text(64.0, None), "64");
        assert_eq!(text(0.0, None), "0");
        assert_eq!(text(-2.5e-9, None), "−2.500·10⁻⁹");
        assert_eq!(Measured::new(-1.5, Some(0.25)).latex(), "-1.50 \\pm 0.25");
        assert_eq!(
            Measured::new(-1.5e9, Some(0.25e9)).html(),
            "(−1.50<span class=half> ± 0.25</span>)·10<sup>9</sup>"
        );
    }

    #[test]
    fn plain_numbers() {
        assert_eq!([plain(0.25), plain(4096.0), plain(1e-7), plain(0.0)], ["0.25", "4096", "1e-7", "0"]);
        assert_eq!([short(0.123_46, 4), short(1234.56, 3), short(2.0, 4)], ["0.1235", "1235", "2"]);
        assert_eq!([short(1.799_9, 3), short(1.23e-7, 2), short(f64::NAN, 3)], ["1.80", "1.2e-7", "NaN"]);
        assert_eq!(superscript(-105), "⁻¹⁰⁵");
    }
}
