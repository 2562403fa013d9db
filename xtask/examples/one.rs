fn main() {
    let mut a = std::env::args().skip(1);
    let t = a.next().unwrap();
    for f in a {
        let d = std::fs::read(&f).unwrap();
        let s = std::time::Instant::now();
        xtask::robust::target(&t)(&d);
        println!("{f} {:?}", s.elapsed());
    }
}
