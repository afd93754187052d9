mod broken;
mod handed;
mod kinds;
mod off;
mod random;
mod reader;
mod variants;
mod whole;
