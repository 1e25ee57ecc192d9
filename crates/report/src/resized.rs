//! Scaling of figures to another size.

/// `svg`, a figure of this crate, at another size in pixels: scaled to fit, and centred on a white background.
#[must_use]
pub fn resized(svg: &str, (width, height): (u32, u32)) -> String {
    let Some((head, contents)) = svg.split_once('>') else { return svg.to_owned() };
    let sides: Vec<f64> = head
        .split_once("viewBox=\"0 0 ")
        .and_then(|(_, rest)| rest.split_once('"'))
        .map(|(sides, _)| sides.split(' ').filter_map(|side| side.parse().ok()).collect())
        .unwrap_or_default();
    let [own_width, own_height] = sides[..] else { return svg.to_owned() };
    let pixels_per_unit = (f64::from(width) / own_width).min(f64::from(height) / own_height);
    let (wide, high) = (f64::from(width) / pixels_per_unit, f64::from(height) / pixels_per_unit);
    let (left, top) = ((own_width - wide) / 2.0, (own_height - high) / 2.0);
    format!(
        r##"<svg width="{width}" height="{height}" viewBox="{left} {top} {wide} {high}" xmlns="http://www.w3.org/2000/svg">
<rect x="{left}" y="{top}" width="{wide}" height="{high}" fill="#FFFFFF"/>{contents}"##
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_scaled_to_fit_and_centred() {
        let figure =
            r#"<svg width="100" height="50" viewBox="0 0 200 100" xmlns="..."><circle r="9"/></svg>"#;
        let head = |size| resized(figure, size).lines().next().expect("a line").to_owned();
        assert!(head((400, 200)).contains(r#"width="400" height="200" viewBox="0 0 200 100""#));
        assert!(head((400, 400)).contains(r#"width="400" height="400" viewBox="0 -50 200 200""#));
        assert!(head((40, 10)).contains(r#"width="40" height="10" viewBox="-100 0 400 100""#));
        assert!(resized(figure, (9, 9)).ends_with("<circle r=\"9\"/></svg>"));
    }
}
