mod broken;
mod kinds;
mod whole;
