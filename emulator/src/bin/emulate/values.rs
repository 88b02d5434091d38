//! Numbers on the command line, with their limits.

/// A number of seconds.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..1e9).contains(&value) => Ok(value),
        _ => Err("give a number of seconds from 0 up to 1000000000, such as 10 or 2.5".into()),
    }
}

/// A percentage.
pub fn percent(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (-10.0..=10.0).contains(&value) => Ok(value),
        _ => Err("give a percentage from -10 to 10, such as 0.8".into()),
    }
}

/// A temperature in °C.
pub fn celsius(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (-40.0..=85.0).contains(&value) => Ok(value),
        _ => Err("give a temperature in °C from -40 to 85, where the sensor is specified".into()),
    }
}

/// A seed.
pub fn seed(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| "give a whole number from 0 to 18446744073709551615, such as 7".into())
}

/// A byte in hexadecimal.
pub fn byte(text: &str) -> Result<u8, String> {
    let digits = text.strip_prefix("0x").unwrap_or(text);
    u8::from_str_radix(digits, 16).map_err(|_| "give a byte in hexadecimal, such as 0x71".into())
}
