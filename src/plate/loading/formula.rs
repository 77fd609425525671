//! A formula in x and y, as `200 * (1 - (x/15)^2) * exp(-0.5 * (x/15)^2)`, or in names that the caller knows.
//!
//! Rules of written mathematics: `-x^2` is -(x²), `a^b^c` is a^(b^c), `1/2` is a half. (Crates that read formulas bind the minus before
//! the power, or divide whole numbers without remainder; either would turn a stress into another one without a word.)

use perilife_base::error::fail_if;

#[derive(Debug, Clone, Copy)]
enum Function {
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
}

const FUNCTIONS: &[(&str, Function)] = &[
    ("sin", Function::One(f64::sin)),
    ("cos", Function::One(f64::cos)),
    ("tan", Function::One(f64::tan)),
    ("atan", Function::One(f64::atan)),
    ("sinh", Function::One(f64::sinh)),
    ("cosh", Function::One(f64::cosh)),
    ("tanh", Function::One(f64::tanh)),
    ("exp", Function::One(f64::exp)),
    ("ln", Function::One(f64::ln)),
    ("sqrt", Function::One(f64::sqrt)),
    ("abs", Function::One(f64::abs)),
    ("min", Function::Two(f64::min)),
    ("max", Function::Two(f64::max)),
];

pub const KNOWN: &str = "numbers, x, y, pi, + - * / ^, brackets, sin cos tan atan sinh cosh tanh exp ln sqrt abs min max";
const DEPTH_MOST: usize = 100;

#[derive(Debug, Clone)]
enum Step {
    Number(f64),
    X,
    Y,
    /// A name of the caller with so many values in brackets.
    Named(String, usize),
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
}

#[derive(Debug, Clone)]
pub struct Formula(Vec<Step>);

impl Formula {
    /// Reads a formula. Errors: in words, what is wrong and at which character, counted from 1.
    pub fn parse(text: &str) -> Result<Formula, String> {
        Formula::read(text, false)
    }

    /// Reads a formula in any names, with values in brackets or without, for [`Formula::of_names`]. Errors: as [`Formula::parse`].
    pub fn parse_named(text: &str) -> Result<Formula, String> {
        Formula::read(text, true)
    }

    fn read(text: &str, has_names: bool) -> Result<Formula, String> {
        let mut reader = Reader { text: text.as_bytes(), at: 0, depth: 0, has_names, steps: Vec::new() };
        reader.sum()?;
        if reader.peek().is_some() { Err(reader.wrong("syntax error")) } else { Ok(Formula(reader.steps)) }
    }

    pub fn at(&self, place: [f64; 2]) -> f64 {
        self.value::<()>(place, |_, _| Err(())).unwrap_or(f64::NAN)
    }

    /// Its value with what names stand for. Errors: those of `named`.
    pub fn of_names<E>(&self, named: impl FnMut(&str, &[f64]) -> Result<f64, E>) -> Result<f64, E> {
        self.value([f64::NAN; 2], named)
    }

    fn value<E>(&self, [x, y]: [f64; 2], mut named: impl FnMut(&str, &[f64]) -> Result<f64, E>) -> Result<f64, E> {
        let mut stack: Vec<f64> = Vec::with_capacity(8);
        for step in &self.0 {
            let value = match step {
                Step::Number(value) => *value,
                Step::X => x,
                Step::Y => y,
                Step::Named(name, count) => named(name, &stack.split_off(stack.len().saturating_sub(*count)))?,
                Step::One(of) => of(stack.pop().unwrap_or(f64::NAN)),
                Step::Two(of) => {
                    let right = stack.pop().unwrap_or(f64::NAN);
                    of(stack.pop().unwrap_or(f64::NAN), right)
                }
            };
            stack.push(value);
        }
        Ok(stack.pop().unwrap_or(f64::NAN))
    }
}

/// Reads from left to right; operators follow their operands in `steps`.
struct Reader<'a> {
    text: &'a [u8],
    at: usize,
    depth: usize,
    has_names: bool,
    steps: Vec<Step>,
}

impl Reader<'_> {
    fn peek(&mut self) -> Option<u8> {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        self.text.get(self.at).copied()
    }

    fn take(&mut self, wanted: u8) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += usize::from(found);
        found
    }

    fn wrong(&self, problem: &str) -> String {
        let rest = String::from_utf8_lossy(&self.text[self.at.min(self.text.len())..]);
        let shown: String = rest.chars().take(12).collect();
        let what = if shown.is_empty() { "its end".to_owned() } else { format!("\"{shown}\"") };
        format!("{problem} at character {}, {what}", self.at + 1)
    }

    fn expect(&mut self, wanted: u8, name: &str) -> Result<(), String> {
        if self.take(wanted) { Ok(()) } else { Err(self.wrong(&format!("expected {name}"))) }
    }

    fn sum(&mut self) -> Result<(), String> {
        self.product()?;
        loop {
            let of: fn(f64, f64) -> f64 = match self.peek() {
                Some(b'+') => |a, b| a + b,
                Some(b'-') => |a, b| a - b,
                _ => return Ok(()),
            };
            self.at += 1;
            self.product()?;
            self.steps.push(Step::Two(of));
        }
    }

    fn product(&mut self) -> Result<(), String> {
        self.signed()?;
        loop {
            let of: fn(f64, f64) -> f64 = match self.peek() {
                Some(b'*') => |a, b| a * b,
                Some(b'/') => |a, b| a / b,
                _ => return Ok(()),
            };
            self.at += 1;
            self.signed()?;
            self.steps.push(Step::Two(of));
        }
    }

    fn signed(&mut self) -> Result<(), String> {
        self.depth += 1;
        fail_if!(self.depth > DEPTH_MOST, self.wrong("is nested too deeply"));
        if self.take(b'-') {
            self.signed()?;
            self.steps.push(Step::One(|a| -a));
        } else if self.take(b'+') {
            self.signed()?;
        } else {
            self.operand()?;
            if self.take(b'^') {
                self.signed()?;
                self.steps.push(Step::Two(f64::powf));
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn operand(&mut self) -> Result<(), String> {
        match self.peek() {
            Some(b'(') => {
                self.at += 1;
                self.sum()?;
                self.expect(b')', "a closing bracket")
            }
            Some(c) if c.is_ascii_digit() || c == b'.' => self.number(),
            Some(c) if c.is_ascii_alphabetic() => self.name(),
            _ => Err(self.wrong("expected a number, x, y or a function")),
        }
    }

    fn number(&mut self) -> Result<(), String> {
        let (start, text) = (self.at, self.text);
        let is_digit = |at: usize| text.get(at).is_some_and(u8::is_ascii_digit);
        while is_digit(self.at) || text.get(self.at) == Some(&b'.') {
            self.at += 1;
        }
        if text.get(self.at).is_some_and(|c| matches!(c, b'e' | b'E')) {
            let sign = usize::from(text.get(self.at + 1).is_some_and(|c| matches!(c, b'+' | b'-')));
            if is_digit(self.at + 1 + sign) {
                self.at += 1 + sign;
                while is_digit(self.at) {
                    self.at += 1;
                }
            }
        }
        let number = std::str::from_utf8(&text[start..self.at]).ok().and_then(|digits| digits.parse::<f64>().ok());
        let Some(number) = number else {
            self.at = start;
            return Err(self.wrong("contains no number"));
        };
        self.steps.push(Step::Number(number));
        Ok(())
    }

    fn name(&mut self) -> Result<(), String> {
        let (start, has_names) = (self.at, self.has_names);
        while self.text.get(self.at).is_some_and(|c| c.is_ascii_alphanumeric() || (has_names && *c == b'_')) {
            self.at += 1;
        }
        let name = String::from_utf8_lossy(&self.text[start..self.at]).into_owned();
        match name.as_str() {
            "x" if !has_names => self.steps.push(Step::X),
            "y" if !has_names => self.steps.push(Step::Y),
            "pi" => self.steps.push(Step::Number(std::f64::consts::PI)),
            _ => {
                let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
                    if has_names {
                        return self.values(name);
                    }
                    self.at = start;
                    return Err(self.wrong("has an unknown name"));
                };
                self.expect(b'(', "an opening bracket")?;
                self.sum()?;
                let step = match *function {
                    Function::One(of) => Step::One(of),
                    Function::Two(of) => {
                        self.expect(b',', "a comma and a second value")?;
                        self.sum()?;
                        Step::Two(of)
                    }
                };
                self.expect(b')', "a closing bracket")?;
                self.steps.push(step);
            }
        }
        Ok(())
    }

    fn values(&mut self, name: String) -> Result<(), String> {
        let mut count = 0;
        if self.take(b'(') {
            while count == 0 || self.take(b',') {
                self.sum()?;
                count += 1;
            }
            self.expect(b')', "a closing bracket")?;
        }
        self.steps.push(Step::Named(name, count));
        Ok(())
    }
}
